//! Map projections as the labels of planetary products name them.

use crate::{Crs, Projection};

/// How far from a pole, in degrees, a centre may be written and still mean the pole.
const POLE_TOLERANCE_DEG: f64 = 1e-9;

/// What a label says of its map. Angles in degrees, lengths in metres.
#[derive(Debug, Clone, PartialEq)]
pub(super) struct Map<'a> {
    pub(super) target: &'a str,
    /// The projection's name in any spelling: `SIMPLE CYLINDRICAL`, `PolarStereographic`, ..
    pub(super) projection: &'a str,
    pub(super) radius_m: Option<f64>,
    pub(super) polar_radius_m: Option<f64>,
    pub(super) centre_lon_deg: f64,
    /// The parallel that is true to scale, or the pole.
    pub(super) true_lat_deg: f64,
    /// The latitude at which y is 0 on a cylinder.
    pub(super) origin_lat_deg: f64,
    /// Scale at the pole, if the label gives it instead of a parallel true to scale.
    pub(super) scale_at_pole: Option<f64>,
    /// Longitudes grow to the west.
    pub(super) west_positive: bool,
    pub(super) planetocentric: bool,
}

impl Map<'_> {
    /// The coordinate reference system; a projection that is not known is a local plane.
    pub(super) fn crs(&self) -> Crs {
        let plain: String = self
            .projection
            .chars()
            .filter(char::is_ascii_alphabetic)
            .map(|c| c.to_ascii_uppercase())
            .collect();
        let centre_lon_deg =
            if self.west_positive { -self.centre_lon_deg } else { self.centre_lon_deg };
        let (mut radius_m, mut polar_radius_m) = (self.radius_m, self.polar_radius_m);
        let projection = match &plain[..] {
            "EQUIRECTANGULAR" | "EQUIDISTANTCYLINDRICAL" | "SIMPLECYLINDRICAL" => {
                let simple = plain == "SIMPLECYLINDRICAL";
                let parallel = if simple { 0.0 } else { self.true_lat_deg };
                if self.planetocentric && !simple {
                    // These products lay a sphere flat whose radius is the ellipsoid's at the parallel.
                    radius_m = local_radius_m(radius_m, polar_radius_m, parallel);
                    polar_radius_m = radius_m.filter(|_| polar_radius_m.is_some());
                }
                match (self.origin_lat_deg, radius_m) {
                    (0.0, _) => cylinder(centre_lon_deg, parallel, 0.0),
                    (lat, Some(r)) => cylinder(centre_lon_deg, parallel, -r * lat.to_radians()),
                    (_, None) => Projection::Local,
                }
            }
            "POLARSTEREOGRAPHIC" => self.polar(centre_lon_deg),
            _ => Projection::Local,
        };
        let name = [self.target, self.projection].map(str::trim);
        Crs {
            name: name.join(" ").trim().to_owned(),
            body: String::new(),
            radius_m,
            polar_radius_m,
            projection,
        }
    }

    fn polar(&self, centre_lon_deg: f64) -> Projection {
        let lat = self.true_lat_deg;
        let sphere = self.polar_radius_m.is_none_or(|polar| Some(polar) == self.radius_m);
        let at_pole = (lat.abs() - 90.0).abs() <= POLE_TOLERANCE_DEG;
        let scale_at_pole = match self.scale_at_pole {
            Some(scale) if at_pole => scale,
            None if at_pole => 1.0,
            // True scale on a parallel of a sphere (Snyder 1987, Eq. 21-7 with k = 1 there).
            None if sphere && lat != 0.0 && lat.abs() < 90.0 => {
                f64::midpoint(1.0, libm::sin(lat.abs().to_radians()))
            }
            _ => return Projection::Local,
        };
        Projection::PolarStereographic {
            centre_lon_deg,
            pole_lat_deg: 90_f64.copysign(lat),
            scale_at_pole,
            false_easting_m: 0.0,
            false_northing_m: 0.0,
        }
    }
}

fn cylinder(centre_lon_deg: f64, parallel: f64, false_northing_m: f64) -> Projection {
    Projection::Equirectangular {
        centre_lon_deg,
        standard_parallel_deg: parallel,
        false_easting_m: 0.0,
        false_northing_m,
    }
}

/// Distance of an ellipsoid's surface from its centre at a planetocentric latitude, metres.
fn local_radius_m(a: Option<f64>, c: Option<f64>, lat_deg: f64) -> Option<f64> {
    let (Some(a), Some(c)) = (a, c) else { return a };
    if a == c {
        return Some(a);
    }
    let lat = lat_deg.to_radians();
    Some(a * c / libm::hypot(c * libm::cos(lat), a * libm::sin(lat)))
}

/// Metres in a unit of length, or of length a pixel; nothing if it is none.
pub(super) fn metres(unit: &str) -> Option<f64> {
    let unit = unit.trim().to_ascii_lowercase();
    let length = match unit.split_once('/') {
        Some((length, "pixel" | "pixels" | "pix" | "px")) => length,
        Some(_) => return None,
        None => &unit,
    };
    match length.trim() {
        "m" | "meter" | "meters" | "metre" | "metres" => Some(1.0),
        "km" | "kilometer" | "kilometers" | "kilometre" | "kilometres" => Some(1000.0),
        _ => None,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn map(projection: &str, true_lat_deg: f64) -> Map<'_> {
        Map {
            target: "MARS",
            projection,
            radius_m: Some(3_396_190.0),
            polar_radius_m: Some(3_376_200.0),
            centre_lon_deg: 30.0,
            true_lat_deg,
            origin_lat_deg: 0.0,
            scale_at_pole: None,
            west_positive: false,
            planetocentric: true,
        }
    }

    #[test]
    fn a_cylinder_has_the_ellipsoids_radius_at_its_parallel() {
        let at = |lat| map("EQUIRECTANGULAR", lat).crs().radius_m.unwrap();
        assert_eq!(at(0.0), 3_396_190.0);
        assert!((at(90.0) - 3_376_200.0).abs() < 1e-6);
        // 1/r² = cos²/a² + sin²/c² at 30 degrees.
        let inverse = 0.75 / 3_396_190.0_f64.powi(2) + 0.25 / 3_376_200.0_f64.powi(2);
        assert!((at(30.0) - inverse.sqrt().recip()).abs() < 1e-6);
        assert_eq!(map("Simple Cylindrical", 30.0).crs().radius_m, Some(3_396_190.0));
    }

    #[test]
    fn the_hemisphere_is_the_sign_of_the_centre() {
        let south = Map { west_positive: true, ..map("POLAR_STEREOGRAPHIC", -90.0) };
        let Projection::PolarStereographic { pole_lat_deg, centre_lon_deg, scale_at_pole, .. } =
            south.crs().projection
        else {
            panic!("{:?}", south.crs())
        };
        assert_eq!((pole_lat_deg, centre_lon_deg, scale_at_pole), (-90.0, -30.0, 1.0));
        // True at 70 degrees: only a sphere's formula is at hand.
        assert_eq!(map("PolarStereographic", 70.0).crs().projection, Projection::Local);
        assert_eq!(map("Mercator", 0.0).crs().projection, Projection::Local);
    }

    #[test]
    fn units_of_length_are_metres_and_kilometres() {
        assert_eq!(metres("METERS/PIXEL"), Some(1.0));
        assert_eq!(metres("KM/PIX"), Some(1000.0));
        assert_eq!(metres(" km "), Some(1000.0));
        assert_eq!(metres("PIXEL/DEG"), None);
        assert_eq!(metres("deg/pixel"), None);
    }
}
