//! Charts: room for labels, ticks, and the numbers beside the drawing.

use octant_report::chart::{
    Chart, Line, Role, base64, decades, exponents, hour_ticks, json_text, nice_ticks, thinned,
};

/// Texts of the elements of a drawing that begin with some markup, up to its end.
fn parts<'a>(drawing: &'a str, begin: &'a str, end: &'a str) -> Vec<&'a str> {
    drawing.split(begin).skip(1).map(|rest| rest.split(end).next().unwrap()).collect()
}

#[test]
fn long_labels_have_room() {
    // Space of labels that aren't long, px.
    const LEFT: f64 = 52.0;
    let mut chart = Chart::new("Small", "h", "y");
    let line = |y: f64| vec![[0.0, 0.0], [1.0, y]];
    for (y, moves) in [(1.0, false), (3.4e-7, true), (-2.2e6, true)] {
        chart.lines = vec![Line { label: String::new(), role: Role::Primary, points: line(y) }];
        let drawing = chart.render().into_string();
        let left: f64 = parts(&drawing, "class=\"axis\" d=\"M", " ")[0].parse().unwrap();
        let labels: Vec<&str> = parts(&drawing, "class=\"tick y\"", "</text>")
            .into_iter()
            .map(|element| element.split_once('>').unwrap().1)
            .collect();
        let longest = labels.iter().map(|label| label.chars().count()).max().unwrap();
        assert!(left - 7.0 >= 6.5 * longest as f64, "{labels:?}");
        assert_eq!(left > LEFT, moves, "{labels:?}");
    }
}

#[test]
fn a_chart_without_points_says_so() {
    let text = Chart::new("Nothing", "h", "y").render().into_string();
    assert!(text.contains("no data"), "{text}");
}

#[test]
fn ticks_are_round_and_inside() {
    assert_eq!(nice_ticks([-0.3, 1.1], 5, None), [0.0, 0.5, 1.0]);
    assert_eq!(
        hour_ticks([0.0, 72.0], 12.0),
        (0..=12).map(|k| 6.0 * f64::from(k)).collect::<Vec<_>>()
    );
    assert_eq!(decades([0.02, 3.0]).0[1], 10.0);
    assert_eq!(exponents([-2.3, 1.2]), [-2.0, -1.0, 0.0, 1.0]);
}

#[test]
fn thinning_keeps_a_lone_spike() {
    let mut points: Vec<[f64; 2]> = (0..100_000).map(|k| [f64::from(k), 0.0]).collect();
    points[54_321][1] = 7.0;
    let thin = thinned(&points, 900);
    assert!(thin.len() <= 3600);
    assert!(thin.contains(&[54_321.0, 7.0]));
}

#[test]
fn base64_is_that_of_the_standard_but_for_the_tilde() {
    // RFC 4648, section 10, without padding.
    for (plain, coded) in
        [("", ""), ("f", "Zg"), ("fo", "Zm8"), ("foo", "Zm9v"), ("foob", "Zm9vYg")]
    {
        assert_eq!(base64(plain.as_bytes()), coded);
    }
    assert_eq!(base64(&[0x35, 0xa3, 0x5a]), "~a~a");
}

#[test]
fn text_can_not_end_the_script_element() {
    assert_eq!(json_text("a</script>\"\\\n"), r#""a\u003c/script\u003e\"\\\u000a""#);
}
