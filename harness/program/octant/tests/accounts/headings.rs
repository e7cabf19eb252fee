//! Logs of headings beside a heading that was surveyed, whole and damaged.

use super::table::{Case, Counts, Ends, Part};

const SECONDS: u32 = 600;
const COUNT: u64 = SECONDS as u64 + 1;

const SCENARIO: &str = "schema = 1
[[requirements]]
id = \"HDG-1\"
text = \"The heading stays within 0.75 deg.\"
measure = \"navigation.heading_error_arcmin.max\"
limit = \"45 arcmin\"
[source.trajectory]
true_heading = \"359.9 deg\"
true_heading_uncertainty = \"0.05 deg\"
";

fn sentence(body: &str) -> String {
    let sum = body.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("${body}*{sum:02X}\r\n")
}

fn tagged(fields: &str, text: &str) -> String {
    let sum = fields.bytes().fold(0, |sum, byte| sum ^ byte);
    format!("UdPbC\0\\{fields}*{sum:02X}\\{text}")
}

/// A heading that swings through north by 0.3 deg, its error 0.4 deg at most.
fn heading_deg(t: u32) -> f64 {
    (359.9 + 0.1 + 0.3 * (f64::from(t) / 30.0).sin()).rem_euclid(360.0)
}

fn clock(t: u32) -> String {
    format!("10{:02}{:02}.00", t / 60, t % 60)
}

fn zda(t: u32) -> String {
    sentence(&format!("GPZDA,{},20,11,2026,00,00", clock(t)))
}

fn hdt(t: u32) -> String {
    sentence(&format!("HEHDT,{:.1},T", heading_deg(t)))
}

fn log(of: impl Fn(u32) -> String) -> String {
    (0..=SECONDS).map(of).collect()
}

struct Headings {
    part: Part,
    more: Vec<&'static str>,
}

impl Headings {
    fn row(&mut self, holds: &str, log: impl AsRef<[u8]>, counts: Counts, ends: Ends) {
        let arguments =
            ["score", "--solution", "gyro.nmea", "--scenario", "s.toml", "--out", "out"];
        let files: [(&str, &[u8]); 2] =
            [("s.toml", SCENARIO.as_bytes()), ("gyro.nmea", log.as_ref())];
        let counts: &[_] = match ends {
            Ends::Refused(_) => &[],
            _ => &[("solution gyro.nmea", counts)],
        };
        let case = Case { input: "nmea", holds, files: &files, set: &[], counts, ends };
        self.part.ends(&case, &[&arguments[..], &self.more].concat());
    }

    fn refused(&mut self, holds: &str, log: impl AsRef<[u8]>, words: &'static str) {
        self.row(holds, log, Counts::default(), Ends::Refused(words));
    }
}

#[test]
fn headings() {
    let mut score = Headings { part: Part::new("headings"), more: Vec::new() };
    let used = Counts::used;
    score.row(
        "HDT behind a ZDA, one a second",
        log(|t| zda(t) + &hdt(t)),
        used(2 * COUNT),
        Ends::Pass,
    );
    let ths = |mode: &str, t: u32| sentence(&format!("HETHS,{:.2},{mode}", heading_deg(t)));
    score.row("THS of mode A", log(|t| zda(t) + &ths("A", t)), used(2 * COUNT), Ends::Pass);
    score.row(
        "THS of mode E, an estimate",
        log(|t| zda(t) + &ths("E", t)),
        used(2 * COUNT),
        Ends::Pass,
    );
    let missing =
        Ends::Inconclusive("of the solution are missing, incomplete, or have no reference");
    for (mode, holds) in [
        ("V", "THS of mode V for 100 s, invalid"),
        ("M", "THS of mode M for 100 s, manual input"),
        ("S", "THS of mode S for 100 s, a simulator"),
    ] {
        let text = log(|t| zda(t) + &ths(if (200..300).contains(&t) { mode } else { "A" }, t));
        score.row(holds, text, used(2 * COUNT - 100).left_out(100), missing);
    }
    let among = |t: u32| {
        let rest = ["HEROT,-2.5,A", "VDVBW,0.1,0.0,A,,,V", "VWVHW,,T,,M,0.1,N,0.2,K"];
        zda(t) + &hdt(t) + &rest.map(sentence).concat()
    };
    score.row(
        "ROT, VBW and VHW behind each",
        log(among),
        used(2 * COUNT).left_out(3 * COUNT),
        Ends::Pass,
    );
    let psxn = |t: u32| {
        let quality = u32::from((200..300).contains(&t));
        zda(t)
            + &sentence(&format!("PSXN,20,0,0,{quality},0"))
            + &sentence(&format!("PSXN,23,0.10,-0.20,{:.2},0.00", heading_deg(t)))
    };
    score.row("PSXN, of reduced quality for 100 s", log(psxn), used(3 * COUNT), Ends::Pass);
    let prdid = |t: u32| zda(t) + &sentence(&format!("PRDID,-0.20,0.10,{:.2}", heading_deg(t)));
    score.row("PRDID", log(prdid), used(2 * COUNT), Ends::Pass);
    let pfec = |t: u32| zda(t) + &sentence(&format!("PFEC,GPatt,{:.1},-0.2,+0.1", heading_deg(t)));
    score.row("PFEC", log(pfec), used(2 * COUNT), Ends::Pass);
    let pixse = |t: u32| zda(t) + &hdt(t) + &sentence("PIXSE,ATITUD,-0.210,0.120");
    score.row("HDT and PIXSE", log(pixse), used(2 * COUNT).left_out(COUNT), Ends::Pass);
    let pashr = |t: u32| {
        zda(t)
            + &sentence(&format!(
                "PASHR,{},{:.2},T,0.10,-0.20,,0.010,0.010,0.020,1,0",
                clock(t),
                heading_deg(t)
            ))
    };
    score.row("PASHR, with its own time", log(pashr), used(2 * COUNT), Ends::Pass);
    // 2026-11-20T10:00:00Z.
    let tag =
        |t: u32| tagged(&format!("s:HE0001,n:{t},c:{}", 1_795_168_800 + u64::from(t)), &hdt(t));
    score.row("datagrams of IEC 61162-450 with TAG blocks", log(tag), used(COUNT), Ends::Pass);
    let damaged = log(|t| if t % 100 == 50 { tag(t).replace("HE0001", "HE0002") } else { tag(t) });
    score.row("six damaged TAG blocks", damaged, used(COUNT - 6).left_out(6), Ends::Pass);
    let stamp = |t: u32| format!("2026-11-20T10:{:02}:{:02}.250Z {}", t / 60, t % 60, hdt(t));
    score.row("stamps of a logger", log(stamp), used(COUNT), Ends::Pass);
    let wrong =
        log(|t| zda(t) + &if t % 100 == 50 { hdt(t).replace("HEHDT,", "HEHDT,1") } else { hdt(t) });
    score.row("six HDT with a wrong checksum", wrong, used(2 * COUNT - 6).left_out(6), Ends::Pass);
    let two = |t: u32| zda(t) + &hdt(t) + &hdt(t + 1).replace("$HE", "$GP");
    let two = log(|t| {
        let text = two(t);
        text.lines()
            .map(|line| sentence(line.trim_start_matches('$').split('*').next().unwrap()))
            .collect()
    });
    score.refused("two talkers", &two, "expected one instrument");
    score.more = vec!["--talker", "HE"];
    score.row("the same, and HE is chosen", &two, used(2 * COUNT).left_out(COUNT), Ends::Pass);
    score.more.clear();
    score.refused("HDT alone: no time", log(hdt), "nothing that tells their times");
    score.more = vec!["--set", "source.solution.heading_rate=1 Hz"];
    score.row("the same, and its rate is given", log(hdt), used(COUNT), Ends::Pass);
    score.more.clear();
    let bare = log(|t| zda(t) + &hdt(t));
    let bare: String =
        bare.lines().map(|line| format!("{}\r\n", line.split('*').next().unwrap())).collect();
    score.refused("no checksums", bare, "without a checksum");
    let frozen = log(|t| zda(t) + &sentence("HEHDT,0.1,T"));
    score.row(
        "the same heading all the time",
        frozen,
        used(2 * COUNT),
        Ends::Inconclusive("no number of the solution changes"),
    );
    score.part.finish(22);
}
