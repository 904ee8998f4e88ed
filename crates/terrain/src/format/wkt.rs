//! Well-known text of a map's coordinates, as far as a `.prj` file beside an ESRI ASCII grid needs it (OGC 01-009).

use super::map::Map;
use super::{damaged, pvl::shorten};
use crate::{Crs, Projection, TerrainError};

/// The longest text that is read.
const MAX_BYTES: usize = 1 << 16;

/// One `KEYWORD["name", number, ..` with how many others it is in.
#[derive(Debug, Default, PartialEq)]
struct Node<'a> {
    keyword: &'a str,
    depth: usize,
    name: &'a str,
    numbers: Vec<f64>,
}

/// The coordinates that a projected system's text describes; nothing if the bytes are no well-known text, as the older
/// `.prj` files of lines `Projection ..` are not.
pub(super) fn crs(name: &str, bytes: &[u8]) -> Result<Option<Crs>, TerrainError> {
    let Some(text) =
        bytes.get(..bytes.len().min(MAX_BYTES)).and_then(|b| std::str::from_utf8(b).ok())
    else {
        return Ok(None);
    };
    let Some(nodes) = nodes(text) else {
        return Err(damaged(name, format!("its text {} does not end as it began", shorten(text))));
    };
    let Some(root) = nodes.first() else { return Ok(None) };
    match &root.keyword.to_ascii_uppercase()[..] {
        "PROJCS" | "PROJCRS" | "PROJECTEDCRS" | "LOCAL_CS" | "ENGCRS" => {}
        "GEOGCS" | "GEOGCRS" | "GEODCRS" => {
            let reason =
                format!("its grid is in degrees ({}); project it to metres first", root.keyword);
            return Err(damaged(name, reason));
        }
        _ => return Ok(None),
    }
    check_unit(name, &nodes)?;
    let find = |words: [&str; 2]| {
        nodes.iter().find(|node| words.iter().any(|word| node.keyword.eq_ignore_ascii_case(word)))
    };
    let parameter = |words: &[&str]| {
        let wanted = |node: &&Node<'_>| {
            node.keyword.eq_ignore_ascii_case("PARAMETER")
                && words.iter().any(|word| plain(node.name) == *word)
        };
        nodes.iter().find(wanted).and_then(|node| node.numbers.first().copied())
    };
    let spheroid = find(["SPHEROID", "ELLIPSOID"]).and_then(|node| match node.numbers[..] {
        [radius, flattening, ..] if radius.is_finite() && radius > 0.0 => {
            Some((radius, flattening))
        }
        _ => None,
    });
    let polar = spheroid.map(|(radius, inverse)| match inverse {
        0.0 => radius,
        inverse => radius - radius / inverse,
    });
    let method = find(["PROJECTION", "METHOD"]).map_or("", |node| node.name);
    let simple = match &plain(method)[..] {
        "equidistantcylindrical" | "equirectangular" | "platecarree" => "Equirectangular",
        "polarstereographic" | "stereographicnorthpole" | "stereographicsouthpole" => {
            "Polar Stereographic"
        }
        _ => "",
    };
    let is_polar = simple == "Polar Stereographic";
    let true_lat = if is_polar {
        parameter(&["standardparallel1", "latitudeoforigin", "latitudeofnaturalorigin"])
    } else {
        parameter(&["standardparallel1", "latitudeof1ststandardparallel"])
    };
    let origin = parameter(&["latitudeoforigin", "latitudeofnaturalorigin"]).filter(|_| !is_polar);
    let map = Map {
        target: "",
        projection: simple,
        radius_m: spheroid.map(|(radius, _)| radius),
        polar_radius_m: polar.filter(|radius| radius.is_finite() && *radius > 0.0),
        centre_lon_deg: parameter(&[
            "centralmeridian",
            "longitudeofnaturalorigin",
            "longitudeoforigin",
        ])
        .unwrap_or(0.0),
        true_lat_deg: true_lat.unwrap_or(0.0),
        origin_lat_deg: origin.unwrap_or(0.0),
        scale_at_pole: parameter(&["scalefactor", "scalefactoratnaturalorigin"]),
        west_positive: false,
        planetocentric: false,
    };
    let mut crs = Crs { name: root.name.to_owned(), ..map.crs() };
    let east = parameter(&["falseeasting"]).unwrap_or(0.0);
    let north = parameter(&["falsenorthing"]).unwrap_or(0.0);
    match &mut crs.projection {
        Projection::Equirectangular { false_easting_m, false_northing_m, .. }
        | Projection::PolarStereographic { false_easting_m, false_northing_m, .. } => {
            *false_easting_m += east;
            *false_northing_m += north;
        }
        _ => {}
    }
    Ok(Some(crs))
}

/// The unit of a projected system, which is the one that stands in it directly or in its axes, is the metre.
fn check_unit(name: &str, nodes: &[Node<'_>]) -> Result<(), TerrainError> {
    let lengths = nodes.iter().filter(|node| {
        let direct = node.keyword.eq_ignore_ascii_case("UNIT") && node.depth == 1;
        direct || node.keyword.eq_ignore_ascii_case("LENGTHUNIT")
    });
    for unit in lengths {
        if unit.numbers.first() != Some(&1.0) {
            let found = shorten(unit.name);
            return Err(damaged(
                name,
                format!("its unit is {found} of {:?} m; metres are wanted", unit.numbers),
            ));
        }
    }
    Ok(())
}

/// A name's letters and digits in lower case, so that `Standard_Parallel_1` is `Standard Parallel 1`.
fn plain(name: &str) -> String {
    name.chars().filter(char::is_ascii_alphanumeric).map(|c| c.to_ascii_lowercase()).collect()
}

/// All nodes in the order in which they open. Nothing if brackets or quotes do not close.
fn nodes(text: &str) -> Option<Vec<Node<'_>>> {
    let mut nodes: Vec<Node<'_>> = Vec::new();
    let mut open: Vec<usize> = Vec::new();
    let mut rest = text.trim();
    while !rest.is_empty() {
        if let Some(after) = rest.strip_prefix('"') {
            let (quoted, after) = after.split_once('"')?;
            if let Some(&node) = open.last()
                && nodes[node].name.is_empty()
            {
                nodes[node].name = quoted;
            }
            rest = after;
        } else if let Some(after) = rest.strip_prefix([',', ' ', '\t', '\r', '\n']) {
            rest = after;
        } else if let Some(after) = rest.strip_prefix([']', ')']) {
            open.pop()?;
            rest = after;
        } else {
            let end = rest.find(['[', '(', ']', ')', ',', '"']).unwrap_or(rest.len());
            let word = rest[..end].trim();
            rest = &rest[end..];
            if let Some(after) = rest.strip_prefix(['[', '(']) {
                nodes.push(Node { keyword: word, depth: open.len(), ..Node::default() });
                open.push(nodes.len() - 1);
                rest = after;
            } else if let (Some(&node), Ok(number)) = (open.last(), word.parse::<f64>())
                && number.is_finite()
            {
                nodes[node].numbers.push(number);
            }
        }
    }
    open.is_empty().then_some(nodes)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn both_generations_of_the_text_name_the_same_map() {
        let old = br#"PROJCS["Mars",GEOGCS["G",DATUM["D",SPHEROID["S",3396190.0,0.0]],PRIMEM["R",0.0],
            UNIT["Degree",0.0174532925199433]],PROJECTION["Equidistant_Cylindrical"],PARAMETER["False_Easting",10.0],
            PARAMETER["Central_Meridian",180.0],PARAMETER["Standard_Parallel_1",-5.0],UNIT["Meter",1.0]]"#;
        let new = br#"PROJCRS["Mars",BASEGEOGCRS["G",DATUM["D",ELLIPSOID["S",3396190,0,LENGTHUNIT["metre",1]]]],
            CONVERSION["C",METHOD["Equidistant Cylindrical"],PARAMETER["Latitude of 1st standard parallel",-5],
            PARAMETER["Longitude of natural origin",180],PARAMETER["False easting",10]],CS[Cartesian,2]]"#;
        let crs = |text: &[u8]| super::crs("m.prj", text).unwrap().unwrap();
        assert_eq!(crs(old), crs(new));
        assert_eq!(crs(old).radius_m, Some(3_396_190.0));
        let wanted = Projection::Equirectangular {
            centre_lon_deg: 180.0,
            standard_parallel_deg: -5.0,
            false_easting_m: 10.0,
            false_northing_m: 0.0,
        };
        assert_eq!(crs(old).projection, wanted);
    }

    #[test]
    fn degrees_and_feet_are_refused_and_other_texts_say_nothing() {
        let message = |text: &str| crs("m.prj", text.as_bytes()).unwrap_err().to_string();
        assert!(message("GEOGCS[\"G\",UNIT[\"Degree\",0.017]]").contains("degrees (GEOGCS)"));
        assert!(message("PROJCS[\"P\",UNIT[\"Foot\",0.3048]]").contains("\"Foot\" of [0.3048] m"));
        assert!(message("PROJCS[\"P\",UNIT[\"m\",1]").contains("does not end"));
        assert_eq!(crs("m.prj", b"Projection    GEOGRAPHIC\nUnits DD\n").unwrap(), None);
        assert_eq!(crs("m.prj", b"\xFF").unwrap(), None);
    }
}
