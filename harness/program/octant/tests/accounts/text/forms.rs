//! Lines, fields and headers.

use super::super::rest::{COUNT, RATE_HZ, readings};
use super::super::table::{Case, Counts, Ends};
use super::{FILE, HEADER, Text, csv, regular, stamped};

#[test]
fn forms() {
    let mut text = Text::new("forms of text");
    let used = Counts::used(COUNT);
    let content = csv(&regular());
    // Lines that are no rows.
    text.row(
        "comments and empty lines between rows",
        content.replace("\n20", "\n# a comment\n\n20"),
        &[],
        used,
        Ends::Pass,
    );
    text.row(
        "ends of lines of Windows, and a byte order mark",
        format!("\u{feff}{}", content.replace('\n', "\r\n")),
        &[],
        used,
        Ends::Pass,
    );
    text.row("a last line without an end", content.trim_end(), &[], used, Ends::Pass);
    for (name, with) in [("semicolon", ";"), ("tab", "\t"), ("whitespace", " ")] {
        let set = format!("source.text.delimiter={name}");
        text.row(
            &format!("fields by {name}"),
            content.replace(',', with),
            &[&set],
            used,
            Ends::Pass,
        );
    }
    text.row(
        "fields in quotes",
        content.replace(",0", ",\"0\"").replace("t,gx", "\"t\",\"gx\""),
        &[],
        used,
        Ends::Pass,
    );
    let rows = content.strip_prefix(HEADER).unwrap();
    let numbers = [
        "source.text.header=false",
        "source.text.time_column=1",
        "source.text.gyro.x=2",
        "source.text.gyro.y=3",
        "source.text.gyro.z=4",
        "source.text.accelerometer.x=5",
        "source.text.accelerometer.y=6",
        "source.text.accelerometer.z=7",
    ];
    text.row("no header, columns by number", rows, &numbers, used, Ends::Pass);
    text.row(
        "three lines before the header",
        format!("unit 7\n50 Hz\n\n{content}"),
        &["source.text.skip_lines=3"],
        used,
        Ends::Pass,
    );
    // More rows than the run takes.
    let more = csv(&readings(RATE_HZ, COUNT + 500));
    text.row("10 s more than the run takes", more, &[], used, Ends::Pass);
    text.row(
        "each row as two samples",
        &content,
        &["source.text.split=2", "source.text.rate=\"50 Hz\"", "imu.rate=\"100 Hz\""],
        used,
        Ends::Pass,
    );
    let flat = stamped(&regular(), |row| format!("{:.9}", row.time_s)).replace("-9.7", "-97.");
    text.row("one axis ten times too large", flat, &[], used, Ends::Fail(""));
    // Damaged rows.
    let with_row = |row: &str| {
        let lines: Vec<&str> = content.lines().collect();
        let mut lines: Vec<String> = lines.iter().map(|line| (*line).to_owned()).collect();
        lines[1000] = row.to_owned();
        lines.join("\n")
    };
    text.refused(
        "not a number in a row",
        with_row("29.98,NaN,0,0,0,0,-9.79"),
        &[],
        "line 1001: column 2: found \"NaN\", expected a finite number",
    );
    text.refused(
        "an empty field",
        with_row("29.98,,0,0,0,0,-9.79"),
        &[],
        "line 1001: column 2: found \"\", expected a finite number",
    );
    text.refused(
        "a word in a row",
        with_row("29.98,reset,0,0,0,0,-9.79"),
        &[],
        "line 1001: column 2: found \"reset\"",
    );
    text.refused(
        "a row cut short",
        with_row("29.98,1e-5,0,0"),
        &[],
        "line 1001: found 4 columns, expected ",
    );
    text.refused(
        "commas in numbers and between them",
        content.replace(",-9.", ",-9,"),
        &[],
        "line 2: found 8 columns, expected 7 as in the header",
    );
    text.row("a comma at the end of each row", content.replace('\n', ",\n"), &[], used, Ends::Pass);
    text.refused(
        "the last row cut short",
        &content[..content.len() - 30],
        &[],
        "line 3001: found ",
    );
    text.refused(
        "the header again within the file",
        with_row(HEADER.trim()),
        &[],
        "line 1001: column 1: found \"t\"",
    );
    // Headers.
    text.refused(
        "an empty file",
        "",
        &[],
        "the file ends, expected a line with the names of the columns",
    );
    text.refused("a header alone", HEADER, &[], "the file ends, expected rows of numbers");
    text.refused(
        "no header",
        rows,
        &[],
        "found a row of numbers, expected the names of the columns",
    );
    text.refused(
        "another name in the header",
        content.replace("gz", "wz"),
        &[],
        "no column \"gz\", found t, gx, gy, wz",
    );
    text.refused(
        "two columns of one name",
        content.replace("gz", "gy"),
        &[],
        "found two columns \"gy\", 3 and 4",
    );
    text.refused(
        "a comma where the scenario says tab",
        &content,
        &["source.text.delimiter=tab"],
        "with delimiter = \"comma\" the line has 7 columns",
    );
    text.refused(
        "one line of 100 000 bytes without an end",
        "1".repeat(100_000),
        &[],
        "longer than 65536 bytes",
    );
    text.refused("bytes that aren't text", [0xFF; 400], &[], "");
    two_files(&mut text);
    text.part.finish(25);
}

/// Gyros and accelerometers in files of their own.
fn two_files(text: &mut Text) {
    let second = format!(
        "{}file = \"accel.csv\"\n",
        text.scenario.replace(
            "[source.text.accelerometer]\n",
            "[source.text.accelerometer]\nfile = \"accel.csv\"\n"
        )
    );
    let scenario = second.trim_end_matches("file = \"accel.csv\"\n").to_owned();
    let content = csv(&regular());
    let mut run = |holds: &str, accel: &str, ends: Ends| {
        let files: [(&str, &[u8]); 3] = [
            ("s.toml", scenario.as_bytes()),
            (FILE, content.as_bytes()),
            ("accel.csv", accel.as_bytes()),
        ];
        let counts: &[_] = if ends == Ends::Pass { &[(FILE, Counts::used(COUNT))] } else { &[] };
        text.part.run(&Case {
            input: "rates in two files",
            holds,
            files: &files,
            set: &[],
            counts,
            ends,
        });
    };
    run("the same stamps", &content, Ends::Pass);
    let lines: Vec<&str> = content.lines().collect();
    let without_one = [&lines[..1000], &lines[1001..]].concat().join("\n");
    run(
        "a row of the second one lost",
        &without_one,
        Ends::Refused("accel.csv: line 1001: stamp "),
    );
    run(
        "the second one ends early",
        &lines[..2000].join("\n"),
        Ends::Refused("accel.csv: line 2000: the file ends after 1999 rows"),
    );
}
