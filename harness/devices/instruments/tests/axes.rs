//! Mountings of instruments.

use octant_instruments::{Axes, AxesError};

#[test]
fn the_twenty_four_mountings_and_no_other() {
    let words = ["x", "y", "z", "-x", "-y", "-z"];
    let mut right = 0;
    for a in words {
        for b in words {
            for c in words {
                let mut text = [0u8; 16];
                let mut length = 0;
                for byte in [a, " ", b, " ", c].iter().flat_map(|word| word.bytes()) {
                    text[length] = byte;
                    length += 1;
                }
                let text = core::str::from_utf8(&text[..length]).unwrap();
                let Ok(axes) = Axes::parse(text) else { continue };
                right += 1;
                // In a right-handed frame, the cross product of x and y is z.
                let columns =
                    [[1., 0., 0.], [0., 1., 0.], [0., 0., 1.]].map(|unit| axes.to_body(unit));
                let [u, v, w] = columns;
                let cross = [
                    u[1] * v[2] - u[2] * v[1],
                    u[2] * v[0] - u[0] * v[2],
                    u[0] * v[1] - u[1] * v[0],
                ];
                assert_eq!(cross, w, "{text}");
            }
        }
    }
    assert_eq!(right, 24);
    assert_eq!(Axes::parse("x -y -z").unwrap().to_body([1.0, 2.0, 3.0]), [1.0, -2.0, -3.0]);
    assert_eq!(Axes::parse("x y z"), Ok(Axes::SAME));
    assert_eq!(Axes::parse("x y"), Err(AxesError::Count { found: 2 }));
    assert_eq!(Axes::parse("x up z"), Err(AxesError::Word { number: 2 }));
    assert_eq!(Axes::parse("x x z"), Err(AxesError::Twice));
    assert_eq!(Axes::parse("x y -z"), Err(AxesError::LeftHanded));
}
