//! The grammar of structured names, and gaps in arrays.

use octant_fmu_check::names::{SingleElements, structured};

#[test]
fn structured_names_follow_the_grammar() {
    for name in [
        "v_min",
        "vehicle.engine.speed",
        "robot.axis.'motor #234'",
        "der(x)",
        "der(pipe[3,4].T[14],2)",
        "a[1].b[2,3]",
        "'\\''",
        "_x1",
        "'a.b[1]'.c",
    ] {
        assert_eq!(structured(name), Ok(()), "{name}");
    }
    for (name, at) in [
        ("", 0),
        ("1a", 0),
        ("a b", 1),
        ("a..b", 2),
        ("a.", 2),
        ("a[]", 2),
        ("a[1", 3),
        ("a[1,]", 4),
        ("a[i]", 2),
        ("der(x", 5),
        ("der(x,)", 6),
        ("der()", 4),
        ("''", 1),
        ("'a", 2),
        ("'\\x'", 2),
        ("ä", 0),
        ("a[-1]", 2),
        ("a(1)", 1),
        ("a]", 1),
    ] {
        assert_eq!(structured(name), Err(at), "{name}");
    }
}

#[test]
fn gaps_are_found_in_any_rank() {
    let gaps = |names: &[&str]| {
        let mut arrays = SingleElements::default();
        names.iter().for_each(|name| arrays.add(name));
        arrays
            .gaps()
            .into_iter()
            .map(|(base, missing, _)| format!("{base}[{missing}]"))
            .collect::<Vec<_>>()
    };
    assert!(gaps(&["a[1]", "a[2]", "b[0]", "b[1]", "c[1,1]", "c[1,2]", "x"]).is_empty());
    assert_eq!(gaps(&["a[1]", "a[3]"]), ["a[2]"]);
    assert_eq!(gaps(&["a[2]", "a[3]"]), ["a[1]"]);
    assert_eq!(gaps(&["m[1,1]", "m[2,2]", "m[1,2]"]), ["m[2,1]"]);
    assert_eq!(gaps(&["a[4294967295]"]), ["a[1]"]);
    assert!(gaps(&["a[1]", "a[1,2]", "a[x]", "a[99999999999]"]).is_empty());
}
