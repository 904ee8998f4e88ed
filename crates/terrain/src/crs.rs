//! What map coordinates mean: a body, and a projection of it; and the geo keys that say so in a GeoTIFF.

use std::fmt;

/// The body and the map projection that a file's coordinates belong to, as far as the file says.
///
/// Only the coordinates' meaning: where a grid lies is its [`GridSpec`](wisdom_grid::GridSpec), in metres of
/// this projection.
#[derive(Debug, Clone, PartialEq)]
pub struct Crs {
    /// A name for people, such as `Mars (2015) - Sphere / Ocentric / Equirectangular, clon = 0`; may be empty.
    pub name: String,
    /// What geo keys call the body, its datum and its ellipsoid (`GCS Name = .. |Datum = .. |`); may be empty.
    pub body: String,
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
    /// What the directory refers to as text, one byte a character.
    pub ascii: String,
}

/// How far two angles in degrees may differ and be the same: a tenth of a millimetre on Mars.
const ANGLE_TOLERANCE_DEG: f64 = 1e-9;
/// How far two lengths or scales may differ and be the same, relative to the larger: rounding in writers' decimals.
const RELATIVE_TOLERANCE: f64 = 1e-9;
/// How far two false origins may differ and be the same, metres.
const ORIGIN_TOLERANCE_M: f64 = 1e-4;

impl fmt::Display for Crs {
    /// Projection and radius, for people.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.projection {
            Projection::Equirectangular { centre_lon_deg, standard_parallel_deg, .. } => write!(
                f,
                "equirectangular, centre longitude {centre_lon_deg}, standard parallel {standard_parallel_deg}"
            )?,
            Projection::PolarStereographic { centre_lon_deg, pole_lat_deg, .. } => {
                let pole = if *pole_lat_deg > 0.0 { "north" } else { "south" };
                write!(f, "polar stereographic, {pole} pole, centre longitude {centre_lon_deg}")?;
            }
            Projection::GeoKeys(_) if self.name.is_empty() => f.write_str("another projection")?,
            Projection::GeoKeys(_) => f.write_str(&self.name)?,
            Projection::Local => f.write_str("a local plane")?,
        }
        match self.radius_m {
            Some(radius_m) => write!(f, ", radius {radius_m} m"),
            None => Ok(()),
        }
    }
}

impl Crs {
    /// Longitude and latitude in degrees of a map coordinate in metres, on a sphere (Snyder, 1987); none for an
    /// ellipsoid, or for a projection that is not known here.
    ///
    /// ```
    /// # use wisdom_terrain::{Crs, Projection};
    /// let mars = Crs {
    ///     name: String::new(),
    ///     body: String::new(),
    ///     radius_m: Some(3_396_190.0),
    ///     polar_radius_m: Some(3_396_190.0),
    ///     projection: Projection::Equirectangular {
    ///         centre_lon_deg: 0.0,
    ///         standard_parallel_deg: 0.0,
    ///         false_easting_m: 0.0,
    ///         false_northing_m: 0.0,
    ///     },
    /// };
    /// let (lon, lat) = mars.lon_lat_deg(8_142_616.0, -276_605.0).expect("a sphere");
    /// assert!((lon - 137.370_857).abs() < 1e-6 && (lat + 4.666_494).abs() < 1e-6);
    /// ```
    #[must_use]
    pub fn lon_lat_deg(&self, x_m: f64, y_m: f64) -> Option<(f64, f64)> {
        let radius_m = self.radius_m?;
        if self.polar_radius_m.is_some_and(|polar_m| polar_m != radius_m) {
            return None;
        }
        let (lon_deg, lat_rad) = match self.projection {
            Projection::Equirectangular {
                centre_lon_deg,
                standard_parallel_deg,
                false_easting_m,
                false_northing_m,
            } => {
                let across = radius_m * libm::cos(standard_parallel_deg.to_radians());
                let lon_rad = (x_m - false_easting_m) / across;
                (centre_lon_deg + lon_rad.to_degrees(), (y_m - false_northing_m) / radius_m)
            }
            Projection::PolarStereographic {
                centre_lon_deg,
                pole_lat_deg,
                scale_at_pole,
                false_easting_m,
                false_northing_m,
            } => {
                let (x, y) = (x_m - false_easting_m, y_m - false_northing_m);
                let north = pole_lat_deg.signum();
                let rho = libm::hypot(x, y) / (2.0 * radius_m * scale_at_pole);
                let lon_rad = libm::atan2(x, -north * y);
                let lat_rad = north * (std::f64::consts::FRAC_PI_2 - 2.0 * libm::atan(rho));
                (centre_lon_deg + lon_rad.to_degrees(), lat_rad)
            }
            Projection::GeoKeys(_) | Projection::Local => return None,
        };
        let lat_deg = lat_rad.to_degrees();
        let lon_deg = (lon_deg + 180.0).rem_euclid(360.0) - 180.0;
        (lat_deg.abs() <= 90.0 && lon_deg.is_finite()).then_some((lon_deg, lat_deg))
    }

    /// What geo keys say (OGC GeoTIFF 1.1, annexes B and C).
    ///
    /// Equidistant cylindrical (coordinate transformation 17) and polar stereographic (15, origin at a pole) on a body
    /// given by its radii become parameters. Whatever these cannot express (EPSG codes, other transformations, other
    /// units, a shifted latitude of origin) is kept as [`Projection::GeoKeys`]: no code is looked up. Keys of a vertical
    /// system (4096 and above) say nothing of the map's plane and do not matter for that choice.
    #[must_use]
    pub fn from_geo_keys(keys: &GeoKeys) -> Self {
        let radius_m = keys.positive(SEMI_MAJOR_AXIS);
        let projection = radius_m.and_then(|_| equirectangular(keys).or_else(|| polar(keys)));
        let has_keys = keys.entries().next().is_some();
        Self {
            name: [CITATION, PROJECTED_CITATION]
                .into_iter()
                .find_map(|key| keys.text(key))
                .unwrap_or_default(),
            body: keys.text(GEOGRAPHIC_CITATION).unwrap_or_default(),
            radius_m,
            polar_radius_m: radius_m.and_then(|radius_m| polar_radius(keys, radius_m)),
            projection: match projection {
                Some(projection) => projection,
                None if has_keys => Projection::GeoKeys(keys.clone()),
                None => Projection::Local,
            },
        }
    }

    /// The geo keys that say this, for a raster whose pixels are areas; `None` where keys cannot: a local plane, or a
    /// projection of a body whose radius is not known.
    ///
    /// ```
    /// # use wisdom_terrain::{Crs, Projection};
    /// let mars = Crs {
    ///     name: "Mars, equirectangular".to_owned(),
    ///     body: "GCS Name = Mars".to_owned(),
    ///     radius_m: Some(3_396_190.0),
    ///     polar_radius_m: Some(3_396_190.0),
    ///     projection: Projection::Equirectangular {
    ///         centre_lon_deg: 0.0,
    ///         standard_parallel_deg: 18.5,
    ///         false_easting_m: 0.0,
    ///         false_northing_m: 0.0,
    ///     },
    /// };
    /// assert_eq!(Crs::from_geo_keys(&mars.to_geo_keys().unwrap()), mars);
    /// ```
    #[must_use]
    pub fn to_geo_keys(&self) -> Option<GeoKeys> {
        let parameters = match &self.projection {
            Projection::Local => return None,
            Projection::GeoKeys(keys) => return Some(keys.with_pixels_as_areas()),
            &Projection::Equirectangular {
                centre_lon_deg,
                standard_parallel_deg,
                false_easting_m,
                false_northing_m,
            } => Parameters {
                transformation: EQUIRECTANGULAR,
                keys: vec![
                    (STANDARD_PARALLEL, standard_parallel_deg),
                    (FALSE_EASTING, false_easting_m),
                    (FALSE_NORTHING, false_northing_m),
                    (CENTRE_LON, centre_lon_deg),
                    (CENTRE_LAT, 0.0),
                ],
            },
            &Projection::PolarStereographic {
                centre_lon_deg,
                pole_lat_deg,
                scale_at_pole,
                false_easting_m,
                false_northing_m,
            } => Parameters {
                transformation: POLAR_STEREOGRAPHIC,
                keys: vec![
                    (ORIGIN_LAT, pole_lat_deg),
                    (FALSE_EASTING, false_easting_m),
                    (FALSE_NORTHING, false_northing_m),
                    (ORIGIN_SCALE, scale_at_pole),
                    (STRAIGHT_POLE_LON, centre_lon_deg),
                ],
            },
        };
        Some(self.user_defined(self.radius_m?, &parameters))
    }

    /// Whether coordinates of both mean the same places: the same projection with the same parameters on a body of the
    /// same radii, within rounding (1e-9 degrees, 1e-9 of a radius or scale, 0.1 mm of a false origin). Names do not
    /// matter. Central meridians may differ by whole turns. Geo keys kept as they are compare key by key, without
    /// citations, vertical keys and the raster type.
    #[must_use]
    pub fn same_projection(&self, other: &Self) -> bool {
        let radii = |crs: &Self| (crs.radius_m, crs.polar_radius_m.or(crs.radius_m));
        let (mine, theirs) = (radii(self), radii(other));
        same_length(mine.0, theirs.0)
            && same_length(mine.1, theirs.1)
            && self.projection.same(&other.projection)
    }

    /// Keys of a body and a projection that no code stands for.
    fn user_defined(&self, radius_m: f64, parameters: &Parameters) -> GeoKeys {
        let polar_radius_m = self.polar_radius_m.unwrap_or(radius_m);
        let body = if polar_radius_m == radius_m {
            format!("Sphere of {radius_m} m")
        } else {
            format!("Ellipsoid of {radius_m} m and {polar_radius_m} m")
        };
        let name = if self.name.is_empty() { "unnamed" } else { &self.name };
        let mut keys = KeyWriter::default();
        keys.short(MODEL_TYPE, PROJECTED);
        keys.short(RASTER_TYPE, PIXEL_IS_AREA);
        keys.text(CITATION, name);
        keys.short(GEOGRAPHIC_TYPE, USER_DEFINED);
        let made = format!(
            "GCS Name = {body}|Datum = {body}|Ellipsoid = {body}|Primem = Reference Meridian|"
        );
        let told = format!("{}|", self.body);
        keys.text(GEOGRAPHIC_CITATION, if self.body.is_empty() { &made } else { &told });
        keys.short(DATUM, USER_DEFINED);
        keys.short(ANGULAR_UNIT, DEGREE);
        keys.short(ELLIPSOID, USER_DEFINED);
        keys.double(SEMI_MAJOR_AXIS, radius_m);
        keys.double(SEMI_MINOR_AXIS, polar_radius_m);
        keys.double(PRIME_MERIDIAN_LON, 0.0);
        keys.short(PROJECTED_TYPE, USER_DEFINED);
        keys.short(PROJECTION, USER_DEFINED);
        keys.short(TRANSFORMATION, parameters.transformation);
        keys.short(LINEAR_UNIT, METRE);
        for &(key, value) in &parameters.keys {
            keys.double(key, value);
        }
        keys.finish()
    }
}

/// A coordinate transformation and its numbers, in the order of the keys.
struct Parameters {
    transformation: u16,
    keys: Vec<(u16, f64)>,
}

impl Projection {
    fn same(&self, other: &Self) -> bool {
        match (self, other) {
            (
                Self::Equirectangular {
                    centre_lon_deg: lon,
                    standard_parallel_deg: parallel,
                    false_easting_m: east,
                    false_northing_m: north,
                },
                Self::Equirectangular {
                    centre_lon_deg,
                    standard_parallel_deg,
                    false_easting_m,
                    false_northing_m,
                },
            ) => {
                // Only the cosine of the parallel matters: its sign does not.
                same_meridian(*lon, *centre_lon_deg)
                    && same_angle(parallel.abs(), standard_parallel_deg.abs())
                    && same_origin(*east, *false_easting_m)
                    && same_origin(*north, *false_northing_m)
            }
            (
                Self::PolarStereographic {
                    centre_lon_deg: lon,
                    pole_lat_deg: pole,
                    scale_at_pole: scale,
                    false_easting_m: east,
                    false_northing_m: north,
                },
                Self::PolarStereographic {
                    centre_lon_deg,
                    pole_lat_deg,
                    scale_at_pole,
                    false_easting_m,
                    false_northing_m,
                },
            ) => {
                same_meridian(*lon, *centre_lon_deg)
                    && same_angle(*pole, *pole_lat_deg)
                    && same_length(Some(*scale), Some(*scale_at_pole))
                    && same_origin(*east, *false_easting_m)
                    && same_origin(*north, *false_northing_m)
            }
            (Self::GeoKeys(mine), Self::GeoKeys(theirs)) => mine.same_place(theirs),
            (Self::Local, Self::Local) => true,
            _ => false,
        }
    }
}

fn same_angle(a: f64, b: f64) -> bool {
    (a - b).abs() <= ANGLE_TOLERANCE_DEG
}

fn same_meridian(a: f64, b: f64) -> bool {
    let turn = (a - b).rem_euclid(360.0);
    turn.min(360.0 - turn) <= ANGLE_TOLERANCE_DEG
}

fn same_origin(a: f64, b: f64) -> bool {
    (a - b).abs() <= ORIGIN_TOLERANCE_M
}

fn same_length(a: Option<f64>, b: Option<f64>) -> bool {
    match (a, b) {
        (Some(a), Some(b)) => (a - b).abs() <= RELATIVE_TOLERANCE * a.abs().max(b.abs()),
        (a, b) => a == b,
    }
}

// Keys of the GeoTIFF standard 1.1, by number.
pub(crate) const MODEL_TYPE: u16 = 1024;
pub(crate) const RASTER_TYPE: u16 = 1025;
const CITATION: u16 = 1026;
const GEOGRAPHIC_TYPE: u16 = 2048;
const GEOGRAPHIC_CITATION: u16 = 2049;
const DATUM: u16 = 2050;
const PRIME_MERIDIAN: u16 = 2051;
const GEOGRAPHIC_LINEAR_UNIT: u16 = 2052;
const ANGULAR_UNIT: u16 = 2054;
const ANGULAR_UNIT_SIZE: u16 = 2055;
const ELLIPSOID: u16 = 2056;
const SEMI_MAJOR_AXIS: u16 = 2057;
const SEMI_MINOR_AXIS: u16 = 2058;
const INVERSE_FLATTENING: u16 = 2059;
const PRIME_MERIDIAN_LON: u16 = 2061;
const PROJECTED_TYPE: u16 = 3072;
const PROJECTED_CITATION: u16 = 3073;
const PROJECTION: u16 = 3074;
const TRANSFORMATION: u16 = 3075;
pub(crate) const LINEAR_UNIT: u16 = 3076;
pub(crate) const LINEAR_UNIT_SIZE: u16 = 3077;
const STANDARD_PARALLEL: u16 = 3078;
const ORIGIN_LON: u16 = 3080;
const ORIGIN_LAT: u16 = 3081;
const FALSE_EASTING: u16 = 3082;
const FALSE_NORTHING: u16 = 3083;
const CENTRE_LON: u16 = 3088;
const CENTRE_LAT: u16 = 3089;
const ORIGIN_SCALE: u16 = 3092;
const STRAIGHT_POLE_LON: u16 = 3095;
/// Keys from here on are of a vertical system.
const FIRST_VERTICAL: u16 = 4096;

// Their values.
const PROJECTED: u16 = 1;
pub(crate) const GEOGRAPHIC: u16 = 2;
const PIXEL_IS_AREA: u16 = 1;
pub(crate) const PIXEL_IS_POINT: u16 = 2;
const POLAR_STEREOGRAPHIC: u16 = 15;
const EQUIRECTANGULAR: u16 = 17;
const GREENWICH: u16 = 8901;
pub(crate) const METRE: u16 = 9001;
const DEGREE: u16 = 9102;
const DEGREE_SUPPLIER: u16 = 9122;
pub(crate) const USER_DEFINED: u16 = 32767;

// Where an entry's value lies: in the entry itself, or in one of two tags.
const IN_ENTRY: u16 = 0;
const IN_DOUBLES: u16 = 34736;
const IN_ASCII: u16 = 34737;

/// Keys that belong to every user-defined system that is understood here, whatever its projection.
const COMMON: [u16; 21] = [
    MODEL_TYPE,
    RASTER_TYPE,
    CITATION,
    GEOGRAPHIC_TYPE,
    GEOGRAPHIC_CITATION,
    DATUM,
    PRIME_MERIDIAN,
    GEOGRAPHIC_LINEAR_UNIT,
    ANGULAR_UNIT,
    ANGULAR_UNIT_SIZE,
    ELLIPSOID,
    SEMI_MAJOR_AXIS,
    SEMI_MINOR_AXIS,
    INVERSE_FLATTENING,
    PRIME_MERIDIAN_LON,
    PROJECTED_TYPE,
    PROJECTED_CITATION,
    PROJECTION,
    TRANSFORMATION,
    LINEAR_UNIT,
    LINEAR_UNIT_SIZE,
];

/// The semi-minor axis, given as such or by the inverse flattening (0 for a sphere).
fn polar_radius(keys: &GeoKeys, radius_m: f64) -> Option<f64> {
    keys.positive(SEMI_MINOR_AXIS).or_else(|| {
        let inverse = keys.double(INVERSE_FLATTENING).filter(|f| f.is_finite() && *f >= 0.0)?;
        Some(if inverse == 0.0 { radius_m } else { radius_m * (1.0 - 1.0 / inverse) })
    })
}

/// Whether the keys are those of a user-defined system in metres and degrees from the prime meridian, with no key
/// beyond the common ones and `own`: then its parameters say all.
fn is_plain(keys: &GeoKeys, transformation: u16, own: &[u16]) -> bool {
    let one_of = |key, allowed: &[u16]| keys.short(key).is_none_or(|v| allowed.contains(&v));
    let number = |key, wanted: f64| keys.double(key).is_none_or(|v| v == wanted);
    keys.short(MODEL_TYPE) == Some(PROJECTED)
        && keys.short(TRANSFORMATION) == Some(transformation)
        && [GEOGRAPHIC_TYPE, DATUM, ELLIPSOID, PROJECTED_TYPE, PROJECTION]
            .into_iter()
            .all(|key| one_of(key, &[USER_DEFINED]))
        && one_of(PRIME_MERIDIAN, &[GREENWICH, USER_DEFINED])
        && one_of(GEOGRAPHIC_LINEAR_UNIT, &[METRE])
        && one_of(ANGULAR_UNIT, &[DEGREE, DEGREE_SUPPLIER])
        && one_of(LINEAR_UNIT, &[METRE])
        && number(LINEAR_UNIT_SIZE, 1.0)
        && number(PRIME_MERIDIAN_LON, 0.0)
        && keys
            .entries()
            .map(|entry| entry.key)
            .all(|key| key >= FIRST_VERTICAL || COMMON.contains(&key) || own.contains(&key))
        && own.iter().filter_map(|&key| keys.double(key)).all(f64::is_finite)
}

fn equirectangular(keys: &GeoKeys) -> Option<Projection> {
    let own = [
        STANDARD_PARALLEL,
        ORIGIN_LON,
        ORIGIN_LAT,
        FALSE_EASTING,
        FALSE_NORTHING,
        CENTRE_LON,
        CENTRE_LAT,
    ];
    let zero = |key| keys.double(key).is_none_or(|lat| lat == 0.0);
    let one_meridian = keys.double(ORIGIN_LON).is_none() || keys.double(CENTRE_LON).is_none();
    if !(is_plain(keys, EQUIRECTANGULAR, &own)
        && one_meridian
        && zero(ORIGIN_LAT)
        && zero(CENTRE_LAT))
    {
        return None;
    }
    Some(Projection::Equirectangular {
        centre_lon_deg: keys.double(CENTRE_LON).or_else(|| keys.double(ORIGIN_LON))?,
        standard_parallel_deg: keys.double(STANDARD_PARALLEL)?,
        false_easting_m: keys.double(FALSE_EASTING).unwrap_or(0.0),
        false_northing_m: keys.double(FALSE_NORTHING).unwrap_or(0.0),
    })
}

fn polar(keys: &GeoKeys) -> Option<Projection> {
    let own = [ORIGIN_LAT, FALSE_EASTING, FALSE_NORTHING, ORIGIN_SCALE, STRAIGHT_POLE_LON];
    // An origin off the pole is a parallel true to scale: another set of parameters, which stays as it is.
    let pole_lat_deg = keys.double(ORIGIN_LAT).filter(|lat| lat.abs() == 90.0)?;
    let scale_at_pole = keys.positive(ORIGIN_SCALE)?;
    if !is_plain(keys, POLAR_STEREOGRAPHIC, &own) {
        return None;
    }
    Some(Projection::PolarStereographic {
        centre_lon_deg: keys.double(STRAIGHT_POLE_LON)?,
        pole_lat_deg,
        scale_at_pole,
        false_easting_m: keys.double(FALSE_EASTING).unwrap_or(0.0),
        false_northing_m: keys.double(FALSE_NORTHING).unwrap_or(0.0),
    })
}

/// One entry of the key directory.
#[derive(Debug, Clone, Copy)]
struct Entry {
    key: u16,
    place: u16,
    count: u16,
    value: u16,
}

/// What a key stands for, wherever it lies.
#[derive(Debug, Clone, PartialEq)]
enum Value {
    Short(u16),
    Doubles(Vec<f64>),
    Text(String),
}

impl GeoKeys {
    /// The value of a key that is a short number (a code), if there is one.
    #[must_use]
    pub fn short(&self, key: u16) -> Option<u16> {
        self.find(key, IN_ENTRY).map(|entry| entry.value)
    }

    /// The value of a key that is a double, if there is one.
    #[must_use]
    pub fn double(&self, key: u16) -> Option<f64> {
        let entry = self.find(key, IN_DOUBLES)?;
        self.doubles.get(usize::from(entry.value)).copied()
    }

    /// The value of a key that is text, without the bar that ends it, if there is one.
    #[must_use]
    pub fn text(&self, key: u16) -> Option<String> {
        let entry = self.find(key, IN_ASCII)?;
        let start = usize::from(entry.value);
        let bytes = self.ascii.as_bytes().get(start..start + usize::from(entry.count))?;
        Some(String::from_utf8_lossy(bytes).trim_end_matches(['|', '\0']).trim().to_owned())
    }

    fn positive(&self, key: u16) -> Option<f64> {
        self.double(key).filter(|value| value.is_finite() && *value > 0.0)
    }

    fn entries(&self) -> impl Iterator<Item = Entry> + '_ {
        let fields = self.directory.chunks_exact(4).skip(1);
        fields.map(|e| Entry { key: e[0], place: e[1], count: e[2], value: e[3] })
    }

    fn find(&self, key: u16, place: u16) -> Option<Entry> {
        self.entries().find(|entry| entry.key == key && entry.place == place)
    }

    fn value(&self, entry: Entry) -> Option<Value> {
        match entry.place {
            IN_ENTRY => Some(Value::Short(entry.value)),
            IN_DOUBLES => {
                let start = usize::from(entry.value);
                let doubles = self.doubles.get(start..start + usize::from(entry.count))?;
                Some(Value::Doubles(doubles.to_vec()))
            }
            _ => self.text(entry.key).map(Value::Text),
        }
    }

    /// Keys and values, without citations, vertical keys and the raster type.
    fn meaning(&self) -> Vec<(u16, Option<Value>)> {
        let apart = [RASTER_TYPE, CITATION, GEOGRAPHIC_CITATION, PROJECTED_CITATION];
        let mut all: Vec<_> = self
            .entries()
            .filter(|entry| entry.key < FIRST_VERTICAL && !apart.contains(&entry.key))
            .map(|entry| (entry.key, self.value(entry)))
            .collect();
        all.sort_by_key(|&(key, _)| key);
        all
    }

    fn same_place(&self, other: &Self) -> bool {
        let near = |a: f64, b: f64| {
            // Angles, metres and scales share the doubles: the tightest bound that rounding allows serves all.
            (a - b).abs() <= RELATIVE_TOLERANCE * a.abs().max(b.abs()).max(1.0)
        };
        let (mine, theirs) = (self.meaning(), other.meaning());
        mine.len() == theirs.len()
            && mine.iter().zip(&theirs).all(|(a, b)| {
                a.0 == b.0
                    && match (&a.1, &b.1) {
                        (Some(Value::Doubles(a)), Some(Value::Doubles(b))) => {
                            a.len() == b.len() && a.iter().zip(b).all(|(&a, &b)| near(a, b))
                        }
                        (a, b) => a == b,
                    }
            })
    }

    /// The same keys for a raster whose pixels are areas.
    fn with_pixels_as_areas(&self) -> Self {
        let mut keys = self.clone();
        for entry in keys.directory.chunks_exact_mut(4).skip(1) {
            if entry[0] == RASTER_TYPE && entry[1] == IN_ENTRY {
                entry[3] = PIXEL_IS_AREA;
            }
        }
        keys
    }
}

/// Geo keys in the making, in ascending order.
#[derive(Default)]
struct KeyWriter {
    entries: Vec<[u16; 4]>,
    doubles: Vec<f64>,
    ascii: String,
}

impl KeyWriter {
    fn short(&mut self, key: u16, value: u16) {
        self.entries.push([key, IN_ENTRY, 1, value]);
    }

    fn double(&mut self, key: u16, value: f64) {
        self.entries.push([key, IN_DOUBLES, 1, self.doubles.len() as u16]);
        self.doubles.push(value);
    }

    /// Text is ASCII, ends with a bar and, as names come from outside, is cut to what a count can say.
    fn text(&mut self, key: u16, text: &str) {
        /// Two of these and the counts stay far below 16 bits.
        const LONGEST: usize = 4096;
        let start = self.ascii.len();
        let plain = text.chars().take(LONGEST);
        self.ascii.extend(plain.map(|c| if matches!(c, ' '..='~') { c } else { '?' }));
        self.ascii.push('|');
        self.entries.push([key, IN_ASCII, (self.ascii.len() - start) as u16, start as u16]);
    }

    fn finish(self) -> GeoKeys {
        let mut directory = vec![1, 1, 0, self.entries.len() as u16];
        directory.extend(self.entries.iter().flatten());
        GeoKeys { directory, doubles: self.doubles, ascii: self.ascii }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn sphere(projection: Projection) -> Crs {
        Crs {
            name: "a place".to_owned(),
            body: "GCS Name = a body|Datum = a body|Ellipsoid = a body".to_owned(),
            radius_m: Some(3_396_190.0),
            polar_radius_m: Some(3_396_190.0),
            projection,
        }
    }

    fn eqc(centre_lon_deg: f64, standard_parallel_deg: f64) -> Projection {
        Projection::Equirectangular {
            centre_lon_deg,
            standard_parallel_deg,
            false_easting_m: 0.0,
            false_northing_m: 0.0,
        }
    }

    fn polar_at(pole_lat_deg: f64) -> Projection {
        Projection::PolarStereographic {
            centre_lon_deg: 0.0,
            pole_lat_deg,
            scale_at_pole: 1.0,
            false_easting_m: 1000.0,
            false_northing_m: -2000.0,
        }
    }

    #[test]
    fn both_projections_come_back_from_their_geo_keys() {
        for projection in [eqc(180.0, 8.0), polar_at(90.0), polar_at(-90.0)] {
            let crs = sphere(projection);
            assert_eq!(Crs::from_geo_keys(&crs.to_geo_keys().unwrap()), crs);
            let flat = Crs { polar_radius_m: Some(3_376_200.0), ..crs };
            assert_eq!(Crs::from_geo_keys(&flat.to_geo_keys().unwrap()), flat);
            assert!(!flat.same_projection(&sphere(flat.projection.clone())));
        }
    }

    #[test]
    fn keys_are_in_ascending_order_as_the_standard_wants() {
        for projection in [eqc(0.0, 0.0), polar_at(90.0)] {
            let keys = sphere(projection).to_geo_keys().unwrap();
            assert!(keys.entries().zip(keys.entries().skip(1)).all(|(a, b)| a.key < b.key));
            assert_eq!(usize::from(keys.directory[3]), keys.entries().count());
        }
    }

    #[test]
    fn the_inverse_flattening_gives_the_polar_radius() {
        let mut keys = sphere(polar_at(90.0)).to_geo_keys().unwrap();
        for entry in keys.directory.chunks_exact_mut(4).filter(|e| e[0] == SEMI_MINOR_AXIS) {
            entry[0] = INVERSE_FLATTENING;
        }
        keys.doubles[1] = 169.894_447_223_612;
        let polar_radius_m = Crs::from_geo_keys(&keys).polar_radius_m.unwrap();
        assert!((polar_radius_m - 3_376_200.0).abs() < 1e-4, "{polar_radius_m}");
        keys.doubles[1] = 0.0;
        assert_eq!(Crs::from_geo_keys(&keys).polar_radius_m, Some(3_396_190.0));
    }

    /// Each change leaves keys that the two projections cannot express; none may be lost.
    #[test]
    fn what_is_not_understood_is_kept_word_for_word() {
        let plain = sphere(eqc(0.0, 18.5)).to_geo_keys().unwrap();
        let with = |key: u16, value: u16| {
            let mut keys = plain.clone();
            for entry in keys.directory.chunks_exact_mut(4).skip(1).filter(|e| e[0] == key) {
                entry.copy_from_slice(&[key, IN_ENTRY, 1, value]);
            }
            keys
        };
        let mut shifted = plain.clone();
        *shifted.doubles.last_mut().unwrap() = 5.0;
        for keys in [
            with(PROJECTED_TYPE, 32234),
            with(TRANSFORMATION, 16),
            with(GEOGRAPHIC_TYPE, 4326),
            with(ANGULAR_UNIT, 9101),
            shifted,
        ] {
            let crs = Crs::from_geo_keys(&keys);
            assert_eq!(crs.projection, Projection::GeoKeys(keys.clone()));
            assert_eq!(crs.to_geo_keys(), Some(keys));
            assert!(crs.same_projection(&crs.clone()));
            assert!(!crs.same_projection(&sphere(eqc(0.0, 18.5))));
        }
        assert!(
            !Crs::from_geo_keys(&with(PROJECTED_TYPE, 32234))
                .same_projection(&Crs::from_geo_keys(&with(PROJECTED_TYPE, 32235)))
        );
    }

    #[test]
    fn names_whole_turns_and_the_sign_of_the_parallel_do_not_matter() {
        let a = sphere(eqc(180.0, 8.0));
        let b = Crs { name: String::new(), ..sphere(eqc(-180.0, -8.0)) };
        assert!(a.same_projection(&b));
        assert!(a.same_projection(&Crs { polar_radius_m: None, ..a.clone() }));
        assert!(!a.same_projection(&sphere(eqc(180.0, 8.000_001))));
        assert!(!a.same_projection(&sphere(eqc(179.0, 8.0))));
        assert!(!a.same_projection(&Crs { radius_m: Some(1_737_400.0), ..a.clone() }));
        assert!(!sphere(polar_at(90.0)).same_projection(&sphere(polar_at(-90.0))));
        assert!(!a.same_projection(&sphere(Projection::Local)));
    }

    #[test]
    fn hostile_directories_say_nothing_and_harm_nothing() {
        let keys = GeoKeys {
            directory: vec![
                1,
                1,
                0,
                9,
                SEMI_MAJOR_AXIS,
                IN_DOUBLES,
                1,
                65_535,
                CITATION,
                IN_ASCII,
                65_535,
                65_535,
                1,
            ],
            doubles: vec![f64::NAN],
            ascii: "é".to_owned(),
        };
        let crs = Crs::from_geo_keys(&keys);
        assert_eq!((crs.radius_m, crs.name.as_str()), (None, ""));
        assert!(crs.same_projection(&crs.clone()));
        assert_eq!(Crs::from_geo_keys(&GeoKeys::default()).projection, Projection::Local);
    }
}
