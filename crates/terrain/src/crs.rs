//! What map coordinates mean: a body, and a projection of it.

/// The body and the map projection that a file's coordinates belong to, as far as the file says.
///
/// Only the coordinates' meaning: where a grid lies is its [`GridSpec`](wisdom_grid::GridSpec), in metres of
/// this projection.
#[derive(Debug, Clone, PartialEq)]
pub struct Crs {
    /// A name for people, such as `Mars (2015) - Sphere / Ocentric / Equirectangular, clon = 0`; may be empty.
    pub name: String,
    /// Semi-major axis of the body's ellipsoid, metres: the radius of a sphere.
    pub radius_m: Option<f64>,
    /// Semi-minor axis, metres; equal to the semi-major one on a sphere.
    pub polar_radius_m: Option<f64>,
    /// How the body is laid flat.
    pub projection: Projection,
}

/// A map projection. Angles are in degrees, longitudes positive to the east, latitudes planetocentric on a sphere.
#[derive(Debug, Clone, PartialEq)]
#[non_exhaustive]
pub enum Projection {
    /// Equidistant cylindrical: `x = R·cos(lat_ts)·(lon − lon_0)`, `y = R·lat` (Snyder 1987, section 12), angles in radians there.
    Equirectangular {
        /// Central meridian.
        centre_lon_deg: f64,
        /// Parallel that is true to scale.
        standard_parallel_deg: f64,
        /// Added to x, metres.
        false_easting_m: f64,
        /// Added to y, metres.
        false_northing_m: f64,
    },
    /// Polar stereographic (Snyder 1987, section 21).
    PolarStereographic {
        /// The meridian that runs straight up or down.
        centre_lon_deg: f64,
        /// 90 for the north pole, −90 for the south pole.
        pole_lat_deg: f64,
        /// Scale at the pole.
        scale_at_pole: f64,
        /// Added to x, metres.
        false_easting_m: f64,
        /// Added to y, metres.
        false_northing_m: f64,
    },
    /// Another one, known only by the geo keys of the GeoTIFF it came from, which are kept as they are.
    GeoKeys(GeoKeys),
    /// The file says nothing of it: a local plane in metres.
    Local,
}

/// A GeoTIFF's geo keys (OGC GeoTIFF 1.1), unchanged: the directory with its two tags of parameters.
#[derive(Debug, Clone, PartialEq, Default)]
pub struct GeoKeys {
    /// The key directory: a header of four numbers, then four a key.
    pub directory: Vec<u16>,
    /// What the directory refers to as doubles.
    pub doubles: Vec<f64>,
    /// What the directory refers to as text.
    pub ascii: String,
}
