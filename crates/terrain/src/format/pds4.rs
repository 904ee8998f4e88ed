//! PDS4 arrays: an XML label and a raw file (PDS4 Standards Reference, chapter 4; cartography discipline dictionary).

use roxmltree::{Document, Node, ParsingOptions};
use wisdom_grid::GridSpec;

use super::map::{Map, metres};
use super::pvl::shorten;
use super::raw::{Array, MAX_WHOLE, Missing, Number, Order, Sample};
use super::{GridFile, Siblings, check_size, damaged};
use crate::{Crs, TerrainError};

/// The longest label that is read. Those of real products have some tens of kilobytes.
const MAX_BYTES: usize = 1 << 20;

/// The most nodes in a label.
const MAX_NODES: u32 = 1 << 16;

/// The most attributes of one element, and the most name spaces in a label: an XML reader's time grows with the square
/// of the one, its room with the square of the other.
const MAX_ATTRIBUTES: usize = 1000;
const MAX_NAME_SPACES: usize = 200;

/// Classes of two and three axes that hold one number a cell.
const ARRAYS: [&str; 6] =
    ["Array_2D", "Array_2D_Image", "Array_2D_Map", "Array_3D", "Array_3D_Image", "Array_3D_Map"];

/// Members of `Special_Constants` that are single stored values.
const SPECIAL: [&str; 10] = [
    "missing_constant",
    "invalid_constant",
    "unknown_constant",
    "not_applicable_constant",
    "error_constant",
    "saturated_constant",
    "high_instrument_saturation",
    "high_representation_saturation",
    "low_instrument_saturation",
    "low_representation_saturation",
];

pub(super) fn read(
    name: &str,
    bytes: &[u8],
    siblings: &mut Siblings<'_>,
) -> Result<Vec<GridFile>, TerrainError> {
    let text = std::str::from_utf8(bytes).map_err(|e| damaged(name, e.to_string()))?;
    check_extent(name, text)?;
    // Without a document type there are no entities to expand.
    let options = ParsingOptions { allow_dtd: false, nodes_limit: MAX_NODES, ..Default::default() };
    let document = Document::parse_with_options(text, options)
        .map_err(|e| damaged(name, format!("its label is not sound XML: {e}")))?;
    let label = Element { name, node: document.root_element() };
    let array = label.all(|tag| ARRAYS.contains(&tag)).next().ok_or_else(|| {
        damaged(name, format!("no array in its label; one of {ARRAYS:?} is read"))
    })?;
    let shape = Shape::of(array)?;
    let (spec, crs) = place(label.about("Cartography", array)?, shape.rows, shape.cols)?;
    let file = array.outer().need("file_name")?.text();
    let stored = stored(label, array, &shape)?;
    stored.read(file, &siblings.need(name, file)?, spec, Some(&crs))
}

/// Refuses a label that is out of proportion, before it is parsed.
fn check_extent(name: &str, text: &str) -> Result<(), TerrainError> {
    // Between two `<` there is one tag at most; comments have no attributes.
    let attributes = text
        .split('<')
        .filter(|part| !part.starts_with('!'))
        .map(|part| part.bytes().filter(|&byte| byte == b'=').count())
        .max();
    for (found, limit, what) in [
        (text.len(), MAX_BYTES, "bytes"),
        (attributes.unwrap_or(0), MAX_ATTRIBUTES, "attributes in one element"),
        (text.matches("xmlns").count(), MAX_NAME_SPACES, "name spaces"),
    ] {
        if found > limit {
            let reason = format!("its label has {found} {what}; at most {limit} are read");
            return Err(damaged(name, reason));
        }
    }
    Ok(())
}

/// An element of the label. Tags are compared without their name space.
#[derive(Clone, Copy)]
struct Element<'l> {
    name: &'l str,
    node: Node<'l, 'l>,
}

impl<'l> Element<'l> {
    fn tag(self) -> &'l str {
        self.node.tag_name().name()
    }

    fn all(self, wanted: impl Fn(&str) -> bool) -> impl Iterator<Item = Self> {
        let found = move |node: &Node<'_, '_>| wanted(node.tag_name().name());
        self.node.descendants().filter(found).map(move |node| Self { node, ..self })
    }

    /// The first element of this tag inside this one.
    fn find(self, tag: &str) -> Option<Self> {
        self.all(|found| found == tag).next()
    }

    fn need(self, tag: &str) -> Result<Self, TerrainError> {
        self.find(tag).ok_or_else(|| damaged(self.name, format!("no {tag} in its {}", self.tag())))
    }

    fn outer(self) -> Self {
        Self { node: self.node.parent_element().unwrap_or(self.node), ..self }
    }

    fn text(self) -> &'l str {
        self.node.text().unwrap_or("").trim()
    }

    fn unit(self) -> &'l str {
        self.node.attribute("unit").unwrap_or("")
    }

    /// An error about what an element says: what was found and what is wanted.
    fn wrong(self, wanted: &str) -> TerrainError {
        let line = self.node.document().text_pos_at(self.node.range().start).row;
        let unit = if self.unit().is_empty() { String::new() } else { format!(" {}", self.unit()) };
        let (tag, found) = (shorten(self.tag()), shorten(self.text()));
        let reason =
            format!("line {line} of its label: {tag} is {found}{unit}; {wanted} is wanted");
        damaged(self.name, reason)
    }

    fn number(self, tag: &str) -> Result<Option<f64>, TerrainError> {
        self.find(tag)
            .map(|found| {
                let number: Option<f64> = found.text().parse().ok();
                number.filter(|x| x.is_finite()).ok_or_else(|| found.wrong("a number"))
            })
            .transpose()
    }

    fn whole(self, tag: &str, least: u64) -> Result<u64, TerrainError> {
        let found = self.need(tag)?;
        let number = found.text().parse::<u64>().ok();
        number
            .filter(|x| (least..=MAX_WHOLE).contains(x))
            .ok_or_else(|| found.wrong(&format!("a whole number from {least} to {MAX_WHOLE}")))
    }

    /// A length in metres, by its unit.
    fn length(self, tag: &str) -> Result<f64, TerrainError> {
        let (found, number) = (self.need(tag)?, self.number(tag)?);
        let wanted =
            "a length in metres or kilometres (a grid in degrees has to be projected first)";
        let length = number.zip(metres(found.unit())).map(|(number, unit)| number * unit);
        length.filter(|x| x.is_finite()).ok_or_else(|| found.wrong(wanted))
    }

    fn radius(self, tags: [&str; 2]) -> Result<Option<f64>, TerrainError> {
        let Some(tag) = tags.into_iter().find(|tag| self.find(tag).is_some()) else {
            return Ok(None);
        };
        let radius = self.length(tag)?;
        if radius > 0.0 {
            Ok(Some(radius))
        } else {
            Err(self.need(tag)?.wrong("a positive radius"))
        }
    }

    /// The discipline's element about an array: the one that refers to it, or the only one.
    fn about(self, tag: &str, array: Self) -> Result<Self, TerrainError> {
        let id = array.find("local_identifier").map(Self::text);
        let refers = |element: &Self| {
            let to = element.find("local_identifier_reference").map(Self::text);
            to.is_some() && to == id
        };
        let found = self.all(|found| found == tag).find(refers);
        found.map_or_else(|| self.need(tag), Ok)
    }
}

/// Sides and the bytes from one element to the next along each axis, in elements.
struct Shape {
    rows: usize,
    cols: usize,
    bands: u64,
    steps: [u64; 3],
}

impl Shape {
    /// The axes by name, the last in sequence running fastest.
    fn of(array: Element<'_>) -> Result<Self, TerrainError> {
        let order = array.need("axis_index_order")?;
        if order.text() != "Last Index Fastest" {
            return Err(order.wrong("Last Index Fastest"));
        }
        let mut axes = Vec::new();
        for axis in array.all(|tag| tag == "Axis_Array").take(4) {
            let name = axis.need("axis_name")?;
            let Some(which) = ["Band", "Line", "Sample"].iter().position(|n| *n == name.text())
            else {
                return Err(name.wrong("Band, Line or Sample"));
            };
            axes.push((axis.whole("sequence_number", 1)?, which, axis.whole("elements", 1)?));
        }
        axes.sort_unstable();
        let mut sides = [1; 3];
        let mut steps = [0; 3];
        let mut step = 1_u64;
        for &(_, which, elements) in axes.iter().rev() {
            (sides[which], steps[which]) = (elements, step);
            step = step.saturating_mul(elements);
        }
        let mut names: Vec<usize> = axes.iter().map(|axis| axis.1).collect();
        names.sort_unstable();
        if names != [1, 2] && names != [0, 1, 2] {
            let reason = format!(
                "its array has {} axes; Line, Sample and at most Band are wanted",
                names.len()
            );
            return Err(damaged(array.name, reason));
        }
        let (rows, cols) = (sides[1] as usize, sides[2] as usize);
        check_size(array.name, rows, cols)?;
        Ok(Self { rows, cols, bands: sides[0], steps })
    }
}

fn stored(label: Element<'_>, array: Element<'_>, shape: &Shape) -> Result<Array, TerrainError> {
    let elements = array.need("Element_Array")?;
    let sample = sample(elements.need("data_type")?)?;
    let [band, row, col] = shape.steps.map(|step| step.saturating_mul(sample.bytes() as u64));
    let offset = array.need("offset")?;
    if !offset.unit().is_empty() && !offset.unit().eq_ignore_ascii_case("byte") {
        return Err(offset.wrong("a number of bytes"));
    }
    let (mut values, mut nodata) = (Vec::new(), None);
    if let Some(special) = array.find("Special_Constants") {
        for constant in SPECIAL.iter().filter_map(|tag| special.find(tag)) {
            let wanted = "a number or bits such as 0xFF7FFFFB";
            values.push(sample.constant(constant.text()).ok_or_else(|| constant.wrong(wanted))?);
            nodata.get_or_insert_with(|| constant.text().to_owned());
        }
    }
    let Display { south_first, east_first } = Display::of(label, array)?;
    Ok(Array {
        bands: shape.bands as usize,
        start: array.whole("offset", 0)?,
        order: Order::Steps { band, row, col },
        south_first,
        east_first,
        missing: Missing { values, valid: None },
        nodata,
        scale: elements.number("scaling_factor")?.unwrap_or(1.0),
        offset: elements.number("value_offset")?.unwrap_or(0.0),
        ..Array::plain("PDS4 array", sample, shape.cols)
    })
}

fn sample(kind: Element<'_>) -> Result<Sample, TerrainError> {
    let text = kind.text();
    let number = match &text.replace("LSB", "").replace("MSB", "")[..] {
        "SignedByte" => Number::I8,
        "UnsignedByte" => Number::U8,
        "Signed2" => Number::I16,
        "Unsigned2" => Number::U16,
        "Signed4" => Number::I32,
        "Unsigned4" => Number::U32,
        "Signed8" => Number::I64,
        "Unsigned8" => Number::U64,
        "IEEE754Single" => Number::F32,
        "IEEE754Double" => Number::F64,
        _ => {
            let wanted = "an integer of 1, 2, 4 or 8 bytes or an IEEE754 Single or Double";
            return Err(kind.wrong(wanted));
        }
    };
    Ok(Sample { number, big_endian: text.contains("MSB") })
}

/// Which way lines and samples run on the map.
struct Display {
    south_first: bool,
    east_first: bool,
}

impl Display {
    fn of(label: Element<'_>, array: Element<'_>) -> Result<Self, TerrainError> {
        let Ok(settings) = label.about("Display_Settings", array) else {
            return Ok(Self { south_first: false, east_first: false });
        };
        for (tag, axis) in
            [("horizontal_display_axis", "Sample"), ("vertical_display_axis", "Line")]
        {
            if let Some(found) = settings.find(tag).filter(|found| found.text() != axis) {
                return Err(found.wrong(axis));
            }
        }
        let reversed = |tag, usual: &str, other: &str| match settings.find(tag) {
            Some(found) if found.text() == other => Ok(true),
            Some(found) if found.text() != usual => {
                Err(found.wrong(&format!("{usual} or {other}")))
            }
            _ => Ok(false),
        };
        Ok(Self {
            south_first: reversed("vertical_display_direction", "Top to Bottom", "Bottom to Top")?,
            east_first: reversed("horizontal_display_direction", "Left to Right", "Right to Left")?,
        })
    }
}

/// The grid and its map: the corner is the outer one of the first pixel.
fn place(map: Element<'_>, rows: usize, cols: usize) -> Result<(GridSpec, Crs), TerrainError> {
    let (across, down) = (map.length("pixel_resolution_x")?, map.length("pixel_resolution_y")?);
    if across != down {
        let wanted = format!("a square pixel, {across} m as pixel_resolution_x,");
        return Err(map.need("pixel_resolution_y")?.wrong(&wanted));
    }
    let spec = GridSpec::new(rows, cols, across)?
        .at(map.length("upperleft_corner_x")?, map.length("upperleft_corner_y")?);
    let is = |tag, words: &str| map.find(tag).is_some_and(|found| found.text() == words);
    let projection = map.find("map_projection_name").map_or("", Element::text);
    let origin = map.number("latitude_of_projection_origin")?.unwrap_or(0.0);
    let polar = projection.starts_with("Polar");
    let meridians = ["longitude_of_central_meridian", "straight_vertical_longitude_from_pole"];
    let meridian = if map.find(meridians[0]).is_some() { meridians[0] } else { meridians[1] };
    let facts = Map {
        target: map.find("spheroid_name").map_or("", Element::text),
        projection,
        radius_m: map.radius(["a_axis_radius", "semi_major_radius"])?,
        polar_radius_m: map.radius(["c_axis_radius", "polar_radius"])?,
        centre_lon_deg: map.number(meridian)?.unwrap_or(0.0),
        true_lat_deg: if polar {
            origin
        } else {
            map.number("standard_parallel_1")?.unwrap_or(0.0)
        },
        origin_lat_deg: if polar { 0.0 } else { origin },
        scale_at_pole: map.number("scale_factor_at_projection_origin")?,
        west_positive: is("longitude_direction", "Positive West"),
        planetocentric: !is("latitude_type", "Planetographic"),
    };
    Ok((spec, facts.crs()))
}
