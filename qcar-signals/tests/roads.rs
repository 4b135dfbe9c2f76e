//! Roads of OpenCRG whose header or data are wrong are refused, with the line and what belongs there.

use std::fs;
use std::path::Path;

use qcar_signals::read::recognise;

fn sample(name: &str) -> Vec<u8> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/samples/crg");
    fs::read(folder.join(name)).unwrap()
}

fn says(message: &str, parts: &[&str]) {
    for part in parts {
        assert!(message.contains(part), "`{part}` is not in: {message}");
    }
}

#[test]
fn texts_that_are_no_road_are_refused_with_their_line() {
    let file = sample("handmade_curved_banked_sloped.crg");
    let text = String::from_utf8(file.clone()).unwrap();
    let with = |from: &str, to: &str| {
        assert!(text.contains(from), "{from}");
        recognise(text.replace(from, to).as_bytes()).map_err(|fault| fault.to_string())
    };
    assert!(
        recognise(&file)
            .unwrap()
            .passed_over
            .iter()
            .any(|own| own.name == "reference line phi")
    );
    for (from, to, parts) in [
        ("#:LRFI", "#:LRFX", ["line 37", "the format `LRFX`", "KRBI"]),
        ("= 22.0", "= 23.0", ["23 rows of data", "24 rows", "cut off"]),
        ("= 22.0", "= 21.0", ["23 rows of data", "22 rows", "damaged"]),
        (
            "= 22.0",
            "= 0.0",
            ["line 30", "REFERENCE_LINE_END_U = 0", "an end above the start, 0 m"],
        ),
        (
            "= 22.0",
            "= 22.0\nreference_line_end_u = 22.0",
            [
                "line 31",
                "`reference_line_end_u` again, after line 30",
                "each parameter once",
            ],
        ),
        (
            "INCREMENT = 1.0",
            "INCREMENT = 0.0",
            ["`REFERENCE_LINE_INCREMENT`", "found 0", "positive"],
        ),
        (
            "INCREMENT = 1.0",
            "INCREMENT = one",
            ["line 32", "REFERENCE_LINE_INCREMENT = one", "a number"],
        ),
        (
            "v = -1.250",
            "v = -1.750",
            ["line 43", "v = -1.75 m after that at -1.5 m", "right to left"],
        ),
        (
            " 0.0000000 0.0111111\n 0.0550000",
            " 0.0000000\n 0.0550000",
            ["line 62", "found 1 numbers", "expected 2"],
        ),
        (
            " 0.0550000 0.0550000",
            " 0.055,000 0.0550000",
            ["line 63", "`0.055,000`", "`*missing*`"],
        ),
        (
            "$ROAD_CRG  ",
            "$ROAD_CRG_MODS\nSCALE_Z_GRID = 2\n$ROAD_CRG  ",
            ["line 26", "SCALE_Z_GRID = 2", "modifiers applied"],
        ),
        (
            "$ROAD_CRG  ",
            "$ROAD_CRG_FILE\nother.crg\n$\n$ROAD_CRG  ",
            ["line 25", "another file", "give that file"],
        ),
        (
            "D:long",
            "D:short",
            ["no longitudinal section", "$KD_DEFINITION", "D:long section 1,m"],
        ),
        (
            "v = -1.250,m ",
            "v = -1.250,mm",
            [
                "line 43",
                "the unit `mm` of `long section at v = -1.250`",
                "expected `m`",
            ],
        ),
        (
            "slope,m/m",
            "slope,%",
            ["line 41", "the unit `%` of `reference line slope`", "`m/m`"],
        ),
        (
            "v = -1.250",
            "v = nan",
            ["line 43", "`long section at v = nan`", "the place"],
        ),
        (
            "section at v = -1.250",
            "section 1",
            ["line 43", "`long section 1` beside", "all numbered"],
        ),
        (
            " 0.0220000 0.0220000 0.0220000",
            " 0.0220000 0.0220000**gap*****",
            ["line 41", "no value in row 4 of `reference line slope`", "without gaps"],
        ),
        (
            " 0.0550000 0.0550000",
            "     1e999 0.0550000",
            ["line 63", "`1e999`", "`*missing*`"],
        ),
        (
            "u,m,0,1.0",
            "u,m,0,0.5",
            ["line 38", "found 0.5 m", "1 m, as REFERENCE_LINE_INCREMENT says"],
        ),
    ] {
        says(&with(from, to).unwrap_err(), &parts);
    }
    // The increment stands in the virtual channel, too.
    let from_channel = with("REFERENCE_LINE_INCREMENT = 1.0", "* no increment").unwrap();
    let whole = recognise(&file).unwrap();
    for name in ["u", "v=0"] {
        assert_eq!(from_channel.signal(name).unwrap(), whole.signal(name).unwrap());
    }
}

#[test]
fn headers_of_roads_that_contradict_themselves() {
    let file = sample("missing_border_kdbi.crg");
    for (from, to, parts) in [
        (
            "D:long section 2",
            "D:long section 3",
            ["line 30", "`long section 3`", "`long section 2` or"],
        ),
        (
            "reference_line_end_b      =   1.0",
            "reference_line_end_b      =   2.0",
            [
                "line 14",
                "REFERENCE_LINE_END_B = 0.02, and 0.01 at the start",
                "a column",
            ],
        ),
        (
            "long_section_v_increment  =   2.9",
            "long_section_v_increment  =   2.8",
            ["`ROAD_CRG`", "5 sections whose places do not follow", "agree"],
        ),
    ] {
        let at = file.windows(from.len()).position(|own| own == from.as_bytes()).unwrap();
        let mut wrong = file.clone();
        wrong[at..at + from.len()].copy_from_slice(to.as_bytes());
        says(&recognise(&wrong).unwrap_err().to_string(), &parts);
    }
}
