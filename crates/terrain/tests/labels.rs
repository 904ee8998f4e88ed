//! What labels and side files may say: pointers, sample types, layouts, units, special values, maps.

use wisdom_terrain::{GridFile, Projection, TerrainError, format};

/// A file and those beside it, by name.
fn read(name: &str, bytes: &[u8], beside: &[(&str, &[u8])]) -> Result<GridFile, TerrainError> {
    format::read_with(name, bytes, &mut |wanted| {
        beside.iter().find(|(name, _)| *name == wanted).map(|(_, bytes)| bytes.to_vec())
    })
}

fn message(name: &str, bytes: &[u8], beside: &[(&str, &[u8])]) -> String {
    read(name, bytes, beside).expect_err("a file that is not read").to_string()
}

fn bytes(name: &str) -> Vec<u8> {
    let path = format!("{}/tests/data/{name}", env!("CARGO_MANIFEST_DIR"));
    std::fs::read(path).expect("a file of tests/data")
}

/// A PDS3 label of 2 x 3 big-endian integers of 16 bits in 100 m cells.
fn pds3(pointer: &str, image: &str, map: &str) -> String {
    format!(
        "PDS_VERSION_ID = PDS3\r\nRECORD_TYPE = FIXED_LENGTH\r\nRECORD_BYTES = 6\r\n^IMAGE = {pointer}\r\n\
        OBJECT = IMAGE\r\n LINES = 2\r\n LINE_SAMPLES = 3\r\n SAMPLE_TYPE = MSB_INTEGER\r\n SAMPLE_BITS = 16\r\n\
        {image}\r\nEND_OBJECT = IMAGE\r\nOBJECT = IMAGE_MAP_PROJECTION\r\n MAP_SCALE = 0.1 <KM/PIXEL>\r\n\
        LINE_PROJECTION_OFFSET = 9.5\r\n SAMPLE_PROJECTION_OFFSET = -20.5\r\n A_AXIS_RADIUS = 1737.4 <KM>\r\n\
        MAP_PROJECTION_TYPE = \"SIMPLE CYLINDRICAL\"\r\n{map}\r\nEND_OBJECT = IMAGE_MAP_PROJECTION\r\nEND\r\n"
    )
}

fn words(values: &[i16]) -> Vec<u8> {
    values.iter().flat_map(|value| value.to_be_bytes()).collect()
}

#[test]
fn a_detached_label_points_to_its_file_by_record_byte_or_name() {
    let data = words(&[1, 2, 3, 4, 5, 6]);
    let shifted = [&[0; 6][..], &data].concat();
    for (pointer, file) in [
        ("\"F.IMG\"", &data),
        ("(\"F.IMG\", 1)", &data),
        ("(\"F.IMG\", 2)", &shifted),
        ("(\"F.IMG\", 7 <BYTES>)", &shifted),
    ] {
        let label = pds3(pointer, "", "");
        // The file system may have lost the case of the name.
        for found in ["F.IMG", "f.img"] {
            let grid = read("F.LBL", label.as_bytes(), &[(found, file)]).unwrap();
            assert_eq!(grid.raster.values(), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0], "{pointer}");
        }
    }
    let label = pds3("\"F.IMG\"", "", "");
    let wanted = "F.LBL: its samples are in F.IMG, which is not there beside it";
    assert_eq!(message("F.LBL", label.as_bytes(), &[]), wanted);
    let cut = message("F.LBL", label.as_bytes(), &[("F.IMG", &data[..11])]);
    assert!(cut.contains("11 bytes") && cut.contains("end at byte 12"), "{cut}");
}

#[test]
fn an_attached_image_begins_at_a_record_or_a_byte() {
    let data = words(&[1, 2, 3, 4, 5, 6]);
    for (pointer, padding) in [("200", 199 * 6), ("1201 <BYTES>", 1200)] {
        let mut file = pds3(pointer, "", "").into_bytes();
        file.resize(padding, b' ');
        file.extend_from_slice(&data);
        let grid = read("f.img", &file, &[]).unwrap();
        assert_eq!(grid.raster.values(), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0], "{pointer}");
    }
}

/// No name of a label makes the reader ask for anything outside the label's folder.
#[test]
fn a_label_cannot_reach_out_of_its_folder() {
    for file in ["/etc/passwd", "../f.img", "..", "sub/f.img", "C:f.img", "..\\f.img", ".", ""] {
        let pds3 = pds3(&format!("\"{file}\""), "", "").into_bytes();
        let text = String::from_utf8(bytes("pds4.xml")).unwrap();
        let pds4 = text.replace(">pds4.img<", &format!(">{file}<")).into_bytes();
        let text = String::from_utf8_lossy(&bytes("isis.cub")[..4096]).into_owned();
        let cube = text.replace("Object = Core", &format!("Object = Core\n ^Core = \"{file}\""));
        for (name, label) in [("f.lbl", pds3), ("f.xml", pds4), ("f.cub", cube.into_bytes())] {
            let error =
                format::read_with(name, &label, &mut |asked| panic!("{asked:?} was asked for"));
            let error = error.unwrap_err().to_string();
            assert!(error.contains("a plain name of a file beside it is wanted"), "{error}");
        }
    }
}

/// The offsets count from the centre of the first pixel, as GDAL's PDS driver has it by default.
#[test]
fn a_pds3_map_is_placed_half_a_pixel_from_its_offsets() {
    let grid = read("f", pds3("\"F\"", "", "").as_bytes(), &[("F", &words(&[0; 6]))]).unwrap();
    let spec = grid.raster.spec();
    assert_eq!((spec.rows(), spec.cols(), spec.spacing_m()), (2, 3, 100.0));
    assert_eq!((spec.west_m(), spec.north_m()), (2000.0, 1000.0));
    assert_eq!(grid.body_radius_m(), Some(1_737_400.0));
}

#[test]
fn scaling_missing_values_and_prefixes_of_lines_are_heeded() {
    let image = "SCALING_FACTOR = 0.5\n OFFSET = 10\n MISSING_CONSTANT = 16#8000#\n CORE_NULL = (7, -9)\n\
        INVALID_CONSTANT = \"N/A\"\n LINE_PREFIX_BYTES = 2\n LINE_SUFFIX_BYTES = 4";
    let data = words(&[99, 1, -32768, 3, 0, 0, 99, 7, -9, -6, 0, 0]);
    let grid = read("f", pds3("\"F\"", image, "").as_bytes(), &[("F", &data)]).unwrap();
    assert_eq!(grid.raster.values(), [10.5, 0.0, 11.5, 0.0, 0.0, 7.0]);
    assert_eq!(grid.known.values(), [true, false, true, false, false, true]);
    assert_eq!(grid.about.nodata.as_deref(), Some("16#8000#"));
    assert_eq!((grid.about.scale, grid.about.offset), (0.5, 10.0));
}

/// A text of fewer digits than a float has still means that float.
#[test]
fn a_missing_float_is_known_by_bits_or_by_rounded_digits() {
    let image = |constant: &str| {
        let text = pds3("\"F\"", &format!("MISSING_CONSTANT = {constant}"), "");
        text.replace("MSB_INTEGER", "IEEE_REAL").replace("SAMPLE_BITS = 16", "SAMPLE_BITS = 32")
    };
    for (constant, bits) in
        [("16#C61C4000#", 0xC61C_4000_u32), ("-1.2345679E+38", (-1.234_567_9e38_f32).to_bits())]
    {
        let mut data: Vec<u8> = [1.0_f32; 5].iter().flat_map(|x| x.to_be_bytes()).collect();
        data.extend_from_slice(&bits.to_be_bytes());
        let grid = read("f", image(constant).as_bytes(), &[("F", &data)]).unwrap();
        assert_eq!(grid.known.values(), [true, true, true, true, true, false], "{constant}");
    }
}

#[test]
fn every_sample_type_of_pds3_is_read() {
    let doubles = |big: bool| -> Vec<u8> {
        let each = |x: f64| if big { x.to_be_bytes() } else { x.to_le_bytes() };
        [1.0, 2.0, 3.0, 4.0, 5.0, -6.5].into_iter().flat_map(each).collect()
    };
    let floats = |big: bool| -> Vec<u8> {
        let each = |x: f32| if big { x.to_be_bytes() } else { x.to_le_bytes() };
        [1.0, 2.0, 3.0, 4.0, 5.0, -6.5].into_iter().flat_map(each).collect()
    };
    for (kind, bits, data, last) in [
        ("PC_REAL", 32, floats(false), -6.5),
        ("IEEE_REAL", 32, floats(true), -6.5),
        ("PC_REAL", 64, doubles(false), -6.5),
        ("IEEE_REAL", 64, doubles(true), -6.5),
        ("LSB_INTEGER", 8, vec![1, 2, 3, 4, 5, 250], -6.0),
        ("UNSIGNED_INTEGER", 8, vec![1, 2, 3, 4, 5, 250], 250.0),
        ("LSB_INTEGER", 16, vec![1, 0, 2, 0, 3, 0, 4, 0, 5, 0, 0xFE, 0xFF], -2.0),
        ("LSB_UNSIGNED_INTEGER", 16, vec![1, 0, 2, 0, 3, 0, 4, 0, 5, 0, 0xFE, 0xFF], 65_534.0),
        ("MSB_UNSIGNED_INTEGER", 16, vec![0, 1, 0, 2, 0, 3, 0, 4, 0, 5, 0xFF, 0xFE], 65_534.0),
        ("MSB_INTEGER", 32, [1_i32, 2, 3, 4, 5, -7].map(i32::to_be_bytes).concat(), -7.0),
        (
            "MSB_UNSIGNED_INTEGER",
            32,
            [1_u32, 2, 3, 4, 5, 1 << 31].map(u32::to_be_bytes).concat(),
            2_147_483_648.0,
        ),
    ] {
        let label = pds3("\"F\"", "", "")
            .replace("SAMPLE_TYPE = MSB_INTEGER", &format!("SAMPLE_TYPE = {kind}"))
            .replace("SAMPLE_BITS = 16", &format!("SAMPLE_BITS = {bits}"));
        let grid = read("f", label.as_bytes(), &[("F", &data)]).unwrap();
        assert_eq!(grid.raster.values(), [1.0, 2.0, 3.0, 4.0, 5.0, last], "{kind} {bits}");
    }
    let vax = pds3("\"F\"", "", "").replace("MSB_INTEGER", "VAX_REAL");
    assert!(message("f", vax.as_bytes(), &[]).contains("\"SAMPLE_TYPE\" is \"VAX_REAL\""));
}

#[test]
fn bands_are_told_apart_in_each_interleaving() {
    for (storage, data) in [
        ("BAND_SEQUENTIAL", [1, 2, 3, 4, 5, 6, 11, 12, 13, 14, 15, 16]),
        ("LINE_INTERLEAVED", [1, 2, 3, 11, 12, 13, 4, 5, 6, 14, 15, 16]),
        ("SAMPLE_INTERLEAVED", [1, 11, 2, 12, 3, 13, 4, 14, 5, 15, 6, 16]),
    ] {
        let image = format!("BANDS = 2\n BAND_STORAGE_TYPE = {storage}");
        let label = pds3("\"F\"", &image, "");
        let bands =
            format::read_bands_with("f", label.as_bytes(), &mut |_| Some(words(&data))).unwrap();
        assert_eq!(bands.len(), 2);
        assert_eq!(bands[0].raster.values(), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0], "{storage}");
        assert_eq!(bands[1].raster.values(), [11.0, 12.0, 13.0, 14.0, 15.0, 16.0], "{storage}");
        let error = read("f", label.as_bytes(), &[("F", &words(&data))]).unwrap_err();
        assert!(matches!(error, TerrainError::Bands { bands: 2, .. }), "{error}");
    }
}

#[test]
fn a_pds3_map_is_a_cylinder_a_pole_or_a_local_plane() {
    let crs = |map: &str, projection: &str| {
        let label = pds3("\"F\"", "", map).replace("SIMPLE CYLINDRICAL", projection);
        read("f", label.as_bytes(), &[("F", &words(&[0; 6]))]).unwrap().crs.unwrap()
    };
    let centre = "CENTER_LATITUDE = -90 <DEG>\n CENTER_LONGITUDE = 30 <DEG>";
    let pole = Projection::PolarStereographic {
        centre_lon_deg: 30.0,
        pole_lat_deg: -90.0,
        scale_at_pole: 1.0,
        false_easting_m: 0.0,
        false_northing_m: 0.0,
    };
    assert_eq!(crs(centre, "POLAR STEREOGRAPHIC").projection, pole);
    let centre =
        "CENTER_LATITUDE = 15.0\n CENTER_LONGITUDE = 30\n POSITIVE_LONGITUDE_DIRECTION = WEST";
    let cylinder = Projection::Equirectangular {
        centre_lon_deg: -30.0,
        standard_parallel_deg: 15.0,
        false_easting_m: 0.0,
        false_northing_m: 0.0,
    };
    assert_eq!(crs(centre, "EQUIRECTANGULAR").projection, cylinder);
    assert_eq!(crs("", "SINUSOIDAL").projection, Projection::Local);
}

#[test]
fn what_a_pds3_label_says_wrong_is_named() {
    let wrong = |from: &str, to: &str| {
        let label = pds3("\"F\"", "", "").replace(from, to);
        message("f", label.as_bytes(), &[("F", &words(&[0; 6]))])
    };
    for (from, to, wanted) in [
        (
            "0.1 <KM/PIXEL>",
            "0.1",
            "line 13 of its label: \"MAP_SCALE\" is \"0.1\"; a scale in <M/PIXEL> or <KM/PIXEL>",
        ),
        ("0.1 <KM/PIXEL>", "64 <PIXEL/DEG>", "\"64\" <PIXEL/DEG>"),
        ("0.1 <KM/PIXEL>", "-1 <M/PIXEL>", "a positive scale"),
        ("LINES = 2", "LINES = 2.5", "\"LINES\" is \"2.5\"; a whole number"),
        ("LINES = 2", "LINES = 0", "\"LINES\" is \"0\"; a whole number"),
        ("1737.4 <KM>", "0 <KM>", "a positive radius"),
        ("SAMPLE_BITS = 16", "SAMPLE_BITS = 12", "8, 16 or 32 is wanted"),
        ("9.5", "N/A", "\"LINE_PROJECTION_OFFSET\" is \"N/A\"; a number"),
        (
            "LINE_PROJECTION_OFFSET",
            "X",
            "no LINE_PROJECTION_OFFSET in its \"IMAGE_MAP_PROJECTION\"",
        ),
        ("^IMAGE", "^X", "no ^IMAGE"),
        ("\"F\"", "(1, 2, 3)", "a record, a number of <BYTES>"),
        ("\"F\"", "0", "a record, a number of <BYTES>"),
        (
            "END_OBJECT = IMAGE\r",
            "LINE_DISPLAY_DIRECTION = UP\rEND_OBJECT = IMAGE\r",
            "DOWN is wanted",
        ),
    ] {
        let found = wrong(from, to);
        assert!(found.contains(wanted), "{found}");
    }
}

/// The elements of `pds4.xml` with other samples.
fn pds4(changes: &[(&str, &str)]) -> Vec<u8> {
    let mut text = String::from_utf8(bytes("pds4.xml")).expect("a label in UTF-8");
    for (from, to) in
        [("<elements>48<", "<elements>2<"), ("<elements>64<", "<elements>3<")].iter().chain(changes)
    {
        assert!(text.contains(from), "{from}");
        text = text.replace(from, to);
    }
    text.into_bytes()
}

#[test]
fn every_data_type_of_pds4_is_read() {
    let data = |each: &dyn Fn(i8) -> Vec<u8>| -> Vec<u8> {
        [1, 2, 3, 4, 5, 6].into_iter().flat_map(each).collect()
    };
    for (kind, data) in [
        ("SignedByte", data(&|x| x.to_le_bytes().to_vec())),
        ("UnsignedByte", data(&|x| x.to_le_bytes().to_vec())),
        ("SignedLSB2", data(&|x| i16::from(x).to_le_bytes().to_vec())),
        ("SignedMSB2", data(&|x| i16::from(x).to_be_bytes().to_vec())),
        ("UnsignedLSB2", data(&|x| i16::from(x).to_le_bytes().to_vec())),
        ("UnsignedMSB2", data(&|x| i16::from(x).to_be_bytes().to_vec())),
        ("SignedLSB4", data(&|x| i32::from(x).to_le_bytes().to_vec())),
        ("SignedMSB4", data(&|x| i32::from(x).to_be_bytes().to_vec())),
        ("UnsignedLSB4", data(&|x| i32::from(x).to_le_bytes().to_vec())),
        ("UnsignedMSB4", data(&|x| i32::from(x).to_be_bytes().to_vec())),
        ("SignedLSB8", data(&|x| i64::from(x).to_le_bytes().to_vec())),
        ("SignedMSB8", data(&|x| i64::from(x).to_be_bytes().to_vec())),
        ("UnsignedLSB8", data(&|x| i64::from(x).to_le_bytes().to_vec())),
        ("UnsignedMSB8", data(&|x| i64::from(x).to_be_bytes().to_vec())),
        ("IEEE754LSBSingle", data(&|x| f32::from(x).to_le_bytes().to_vec())),
        ("IEEE754MSBSingle", data(&|x| f32::from(x).to_be_bytes().to_vec())),
        ("IEEE754LSBDouble", data(&|x| f64::from(x).to_le_bytes().to_vec())),
        ("IEEE754MSBDouble", data(&|x| f64::from(x).to_be_bytes().to_vec())),
    ] {
        let label = pds4(&[("IEEE754LSBSingle", kind)]);
        let grid = read("f.xml", &label, &[("pds4.img", &data)]).unwrap();
        assert_eq!(grid.raster.values(), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0], "{kind}");
    }
}

#[test]
fn a_pds4_label_scales_shifts_turns_and_masks() {
    let label = pds4(&[
        (
            "IEEE754LSBSingle</data_type>",
            "UnsignedByte</data_type><scaling_factor>2</scaling_factor><value_offset>-1</value_offset>",
        ),
        ("<offset unit=\"byte\">0<", "<offset unit=\"byte\">4<"),
        ("Top to Bottom", "Bottom to Top"),
        ("Left to Right", "Right to Left"),
        (">-32767<", ">0x05<"),
    ]);
    let data = [9, 9, 9, 9, 1, 2, 3, 4, 5, 6];
    let grid = read("f.xml", &label, &[("pds4.img", &data)]).unwrap();
    assert_eq!(grid.raster.values(), [11.0, 0.0, 7.0, 5.0, 3.0, 1.0]);
    assert_eq!(grid.known.values(), [true, false, true, true, true, true]);
    assert_eq!(
        (grid.raster.spec().west_m(), grid.raster.spec().north_m()),
        (8_142_616.0, -276_605.0)
    );
}

#[test]
fn a_pds4_array_of_two_axes_is_read_and_of_columns_first_too() {
    let band = "<Axis_Array>\n        <axis_name>Band</axis_name>\n        <elements>1</elements>\n        \
        <sequence_number>1</sequence_number>\n      </Axis_Array>";
    let flat =
        [("Array_3D_Image", "Array_2D_Image"), (band, ""), ("IEEE754LSBSingle", "SignedByte")];
    let data = [1, 2, 3, 4, 5, 6];
    let grid = read("f.xml", &pds4(&flat), &[("pds4.img", &data)]).unwrap();
    assert_eq!(grid.raster.values(), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0]);
    let swapped = [&flat[..], &[(">2</sequence_number", ">7</sequence_number")]].concat();
    let grid = read("f.xml", &pds4(&swapped), &[("pds4.img", &data)]).unwrap();
    assert_eq!(grid.raster.values(), [1.0, 3.0, 5.0, 2.0, 4.0, 6.0]);
}

#[test]
fn what_a_pds4_label_says_wrong_is_named() {
    for (from, to, wanted) in [
        (
            "<cart:pixel_resolution_x unit=\"m/pixel\">",
            "<cart:pixel_resolution_x unit=\"deg/pixel\">",
            "(a grid in degrees has to be projected first)",
        ),
        (
            "pixel_resolution_y unit=\"m/pixel\">1<",
            "pixel_resolution_y unit=\"m/pixel\">2<",
            "a square pixel, 1 m",
        ),
        ("IEEE754LSBSingle", "ComplexLSB8", "\"data_type\" is \"ComplexLSB8\""),
        ("Last Index Fastest", "First Index Fastest", "Last Index Fastest is wanted"),
        ("Sample</axis_name", "Time</axis_name", "Band, Line or Sample"),
        ("cart:Cartography>", "cart:Nothing>", "no Cartography in its Product_Observational"),
        (">-32767<", ">none<", "\"missing_constant\" is \"none\""),
        ("<elements>2<", "<elements>-2<", "\"elements\" is \"-2\""),
        ("Array_3D_Image>", "Table_Binary>", "no array in its label"),
    ] {
        let found = message("f.xml", &pds4(&[(from, to)]), &[("pds4.img", &[0; 24])]);
        assert!(found.contains(wanted), "{found}");
    }
}

/// An ISIS label over 2 x 3 pixels of one type.
fn isis(kind: &str, order: &str, format: &str, data: &[u8]) -> Vec<u8> {
    let label = format!(
        "Object = IsisCube\n  Object = Core\n    StartByte = 1025\n    Format = {format}\n\
        Group = Dimensions\n Samples = 3\n Lines = 2\n Bands = 1\n End_Group\n\
        Group = Pixels\n Type = {kind}\n ByteOrder = {order}\n Base = 10\n Multiplier = 0.5\n End_Group\n\
        End_Object\n Group = Mapping\n ProjectionName = Sinusoidal\n TargetName = Moon\n\
        EquatorialRadius = 1737400.0 <meters>\n UpperLeftCornerX = -3 <km>\n UpperLeftCornerY = 500.0 <meters>\n\
        PixelResolution = 20 <meters/pixel>\n End_Group\nEnd_Object\nEnd\n"
    );
    let mut file = label.into_bytes();
    assert!(file.len() <= 1024);
    file.resize(1024, 0);
    file.extend_from_slice(data);
    file
}

#[test]
fn special_pixels_of_each_isis_type_are_unknown() {
    let float = |bits: u32| f32::from_bits(bits).to_be_bytes();
    let (band, lsb, msb) = ("BandSequential", "Lsb", "Msb");
    for (file, known, last) in [
        (
            isis("UnsignedByte", lsb, band, &[0, 255, 1, 254, 2, 3]),
            [false, false, true, true, true, true],
            11.5,
        ),
        (
            isis("SignedWord", msb, band, &words(&[-32768, -32767, -32766, -32753, -32752, 4])),
            [false, false, false, false, true, true],
            12.0,
        ),
        (
            isis("UnsignedWord", msb, band, &words(&[0, 2, -1, -2, 3, 4])),
            [false, false, false, false, true, true],
            12.0,
        ),
        (
            isis(
                "Real",
                msb,
                band,
                &[
                    float(0xFF7F_FFFB),
                    float(0xFF7F_FFFC),
                    float(0xFF7F_FFFD),
                    float(0xFF7F_FFFE),
                    float(0xFF7F_FFFF),
                    float(0x4000_0000),
                ]
                .concat(),
            ),
            [false, false, false, false, false, true],
            11.0,
        ),
    ] {
        let grid = read("f.cub", &file, &[]).unwrap();
        assert_eq!(grid.known.values(), known);
        assert_eq!(grid.raster.values()[5], last);
    }
}

#[test]
fn a_tiled_cube_holds_what_a_sequential_one_holds() {
    // Tiles of one line of two samples: the second of each line is filled up.
    let tile = "Tile\n TileSamples = 2\n TileLines = 1";
    let file = isis("UnsignedByte", "Lsb", tile, &[2, 4, 6, 99, 8, 10, 12, 99]);
    let grid = read("f.cub", &file, &[]).unwrap();
    assert_eq!(grid.raster.values(), [11.0, 12.0, 13.0, 14.0, 15.0, 16.0]);
    let spec = grid.raster.spec();
    assert_eq!((spec.west_m(), spec.north_m(), spec.spacing_m()), (-3000.0, 500.0, 20.0));
    let crs = grid.crs.unwrap();
    assert_eq!((crs.radius_m, crs.projection), (Some(1_737_400.0), Projection::Local));
    // The filling is part of the file.
    assert!(message("f.cub", &file[..file.len() - 1], &[]).contains("end at byte 1032"));
}

#[test]
fn what_an_isis_label_says_wrong_is_named() {
    let wrong = |from: &str, to: &str| {
        let text = String::from_utf8(isis("Real", "Lsb", "BandSequential", &[0; 24])).unwrap();
        assert!(text.contains(from), "{from}");
        message("f.cub", text.replace(from, to).as_bytes(), &[])
    };
    for (from, to, wanted) in [
        ("Type = Real", "Type = Complex", "\"Type\" is \"Complex\""),
        ("= Lsb", "= Pdp", "Lsb or Msb is wanted"),
        ("BandSequential", "Zigzag", "BandSequential or Tile is wanted"),
        ("Group = Mapping", "Group = Other", "no Mapping in its label"),
        ("20 <meters/pixel>", "20 <degrees>", "\"20\" <degrees>; a length in <meters> is wanted"),
        ("20 <meters/pixel>", "0 <meters/pixel>", "cell spacing 0 m"),
        ("1737400.0", "-1", "a positive radius"),
    ] {
        let found = wrong(from, to);
        assert!(found.contains(wanted), "{found}");
    }
}

fn npy(descr: &str, order: &str, shape: &str, data: &[u8]) -> Vec<u8> {
    let header = format!("{{'descr': '{descr}', 'fortran_order': {order}, 'shape': {shape}, }}\n");
    let mut file = b"\x93NUMPY\x01\x00".to_vec();
    file.extend_from_slice(&(header.len() as u16).to_le_bytes());
    file.extend_from_slice(header.as_bytes());
    file.extend_from_slice(data);
    file
}

#[test]
fn every_type_and_order_of_a_numpy_array_is_read() {
    let values = [1.0, 2.0, 3.0, 4.0, 5.0, 6.0];
    let single = |each: fn(f32) -> [u8; 4]| values.map(|x| each(x as f32)).concat();
    let double = |each: fn(f64) -> [u8; 8]| values.map(each).concat();
    for (descr, data) in [
        ("<f4", single(f32::to_le_bytes)),
        (">f4", single(f32::to_be_bytes)),
        ("<f8", double(f64::to_le_bytes)),
        (">f8", double(f64::to_be_bytes)),
        ("|u1", vec![1, 2, 3, 4, 5, 6]),
        ("|i1", vec![1, 2, 3, 4, 5, 6]),
        ("<i2", vec![1, 0, 2, 0, 3, 0, 4, 0, 5, 0, 6, 0]),
        (">u2", vec![0, 1, 0, 2, 0, 3, 0, 4, 0, 5, 0, 6]),
        (">i4", [1_i32, 2, 3, 4, 5, 6].map(i32::to_be_bytes).concat()),
    ] {
        let grid = read("f.npy", &npy(descr, "False", "(2, 3)", &data), &[]).unwrap();
        assert_eq!(grid.raster.values(), [1.0, 2.0, 3.0, 4.0, 5.0, 6.0], "{descr}");
        let grid = read("f.npy", &npy(descr, "True", "(2, 3)", &data), &[]).unwrap();
        assert_eq!(grid.raster.values(), [1.0, 3.0, 5.0, 2.0, 4.0, 6.0], "{descr}");
    }
    for (file, wanted) in [
        (npy("<c8", "False", "(2, 3)", &[]), "descr is \"'<c8'\""),
        (npy("|u1", "Maybe", "(2, 3)", &[]), "fortran_order is \"Maybe\""),
        (npy("|u1", "False", "(6,)", &[]), "shape is \"(6,)\"; (rows, columns) is wanted"),
        (npy("|u1", "False", "(1, 2, 3)", &[]), "(rows, columns) is wanted"),
        (npy("|u1", "False", "(2, 3)", &[0; 5]), "uint8 end at byte"),
        (npy("|u1", "False", "(65535, 65535)", &[0; 5]), "at most 67108864 are read"),
        (b"\x93NUMPY\x09\0\0\0\0\0\0".to_vec(), "its format version is 9"),
        (
            b"\x93NUMPY\x01\0\xff\xff{".to_vec(),
            "a text header of 65535 bytes is not in its 11 bytes",
        ),
    ] {
        let found = message("f.npy", &file, &[]);
        assert!(found.contains(wanted), "{found}");
    }
}

#[test]
fn a_side_file_places_and_scales_what_it_stands_beside() {
    let file = npy("|u1", "False", "(2, 3)", &[1, 2, 3, 4, 5, 6]);
    let side = b"spacing-m = 2\nwest-m = 100\nnorth-m = -7.5\nscale = 10\noffset = 0.5\nnodata = 3\nbody-radius-m = 1000";
    let grid = read("some/folder/f.npy", &file, &[("f.npy.toml", side)]).unwrap();
    let spec = grid.raster.spec();
    assert_eq!((spec.spacing_m(), spec.west_m(), spec.north_m()), (2.0, 100.0, -7.5));
    assert_eq!(grid.raster.values(), [10.5, 20.5, 0.0, 40.5, 50.5, 60.5]);
    assert_eq!(grid.known.values(), [true, true, false, true, true, true]);
    assert_eq!(grid.body_radius_m(), Some(1000.0));
    for (side, wanted) in [
        (&b"spacing-m = 1\nspacing = 2"[..], "f.npy.toml: line 2: unknown field `spacing`"),
        (b"spacing-m = 0", "f.npy.toml: spacing-m is 0; a positive number is wanted"),
        (b"west-m = nan", "west-m is NaN; a finite number is wanted"),
        (b"scale = \"x\"", "f.npy.toml: line 1: invalid type"),
        (b"\xff", "f.npy.toml: invalid utf-8"),
    ] {
        let found = message("f.npy", &file, &[("f.npy.toml", side)]);
        assert!(found.contains(wanted), "{found}");
    }
}

#[test]
fn an_image_without_a_side_file_says_which_one_it_wants() {
    let found = message("dir/height16.png", &bytes("height16.png"), &[]);
    assert!(
        found.ends_with("a side file height16.png.toml with spacing-m, the size of a cell"),
        "{found}"
    );
}

/// A PNG image, or only its header if there are no pixels.
fn png(side: u32, colour: png::ColorType, depth: png::BitDepth, pixels: &[u8]) -> Vec<u8> {
    let mut file = Vec::new();
    let mut encoder = png::Encoder::new(&mut file, side, side);
    encoder.set_color(colour);
    encoder.set_depth(depth);
    let mut writer = encoder.write_header().expect("room in memory");
    if !pixels.is_empty() {
        writer.write_image_data(pixels).expect("as many pixels as said");
    }
    drop(writer);
    file
}

#[test]
fn an_image_is_grey_of_eight_or_sixteen_bits() {
    use png::BitDepth::{Eight, One, Sixteen};
    use png::ColorType::{Grayscale, GrayscaleAlpha, Rgb};
    let side = b"spacing-m = 0.5\nscale = 2\nnodata = 3";
    let grey = png(2, Grayscale, Eight, &[1, 2, 3, 4]);
    let grid = read("g.png", &grey, &[("g.png.toml", side)]).unwrap();
    assert_eq!(grid.raster.values(), [2.0, 4.0, 0.0, 8.0]);
    assert_eq!(grid.known.values(), [true, true, false, true]);
    assert_eq!(grid.about.storage, "uint8, deflate");
    assert_eq!((grid.raster.spec().west_m(), grid.raster.spec().north_m()), (0.0, 1.0));
    for (colour, depth, bytes, found) in [
        (Rgb, Eight, 12, "Rgb of 8 bits"),
        (GrayscaleAlpha, Sixteen, 16, "GrayscaleAlpha of 16 bits"),
        (Grayscale, One, 2, "Grayscale of 1 bits"),
    ] {
        let image = png(2, colour, depth, &vec![0; bytes]);
        let wanted = format!("g.png: it is {found}; grey of 8 or 16 bits is wanted");
        assert_eq!(message("g.png", &image, &[("g.png.toml", side)]), wanted);
    }
}

/// Told from the header and the length of the file, before room is made.
#[test]
fn an_image_that_its_bytes_cannot_hold_is_refused() {
    use png::{BitDepth::Sixteen, ColorType::Grayscale};
    let found = message("g.png", &png(8192, Grayscale, Sixteen, &[]), &[]);
    assert!(found.ends_with("bytes cannot hold 8192 x 8192 cells"), "{found}");
    let error = read("g.png", &png(8193, Grayscale, Sixteen, &[]), &[]).unwrap_err();
    assert!(matches!(error, TerrainError::TooLarge { rows: 8193, cols: 8193, .. }), "{error}");
}

#[test]
fn a_file_that_is_not_there_is_said_to_be_so() {
    let folder = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data");
    let error = format::read_file(&folder.join("nothing.tif")).unwrap_err();
    assert!(matches!(error, TerrainError::Io { .. }), "{error}");
    assert!(error.to_string().contains("nothing.tif: cannot read it: "), "{error}");
    let error = format::read_file(&folder).unwrap_err();
    assert!(error.to_string().ends_with("it is no plain file"), "{error}");
}
