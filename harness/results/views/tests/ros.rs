//! Messages of ROS 2: alignment of their fields, and axes of REP 103.

use nalgebra::Vector3;
use nalgebra::{Quaternion, UnitQuaternion};
use octant_earth::rotation::exp;
use octant_views::ros::{RosMessage, enu, enu_covariance, flu, orientation};

/// Message with a header and these numbers, behind another one in the same buffer.
fn behind_another(time_ns: u64, frame_id: &str, finish: impl Fn(&mut RosMessage<'_>)) -> Vec<u8> {
    let mut bytes = vec![9; 3];
    finish(&mut RosMessage::new(&mut bytes, time_ns, frame_id));
    bytes.split_off(3)
}

#[test]
fn fields_stand_at_multiples_of_their_size() {
    // "abc" ends at byte 16 after the encapsulation: sec 4, nanosec 4, length 4, text 4.
    let bytes = behind_another(1_500_000_007, "abc", |message| {
        message.numbers(&[1.0]);
        message.put(&[7u8]);
        message.put(&3u16.to_le_bytes());
    });
    assert_eq!(&bytes[4..12], [1, 0, 0, 0, 0x07, 0x65, 0xcd, 0x1d]);
    assert_eq!(&bytes[12..20], [4, 0, 0, 0, b'a', b'b', b'c', 0]);
    assert_eq!(bytes[20..28], 1f64.to_le_bytes());
    assert_eq!(&bytes[28..], [7, 0, 3, 0]);
    // A longer name moves the number to the next multiple of eight.
    let bytes = behind_another(0, "abcd", |message| message.numbers(&[1.0]));
    assert_eq!(bytes[28..], 1f64.to_le_bytes());
}

#[test]
fn a_covariance_turns_as_its_vector() {
    // The covariance of one vector that is certain is its outer product.
    let [n, e, d] = [2.0, -3.0, 5.0];
    let found = enu_covariance([n * n, n * e, n * d, e * e, e * d, d * d]);
    let turned = enu([n, e, d]);
    for (i, row) in turned.iter().enumerate() {
        for (j, column) in turned.iter().enumerate() {
            assert_eq!(found[3 * i + j], row * column, "{i} {j}");
        }
    }
}

#[test]
fn heading_north_is_a_quarter_turn_from_east() {
    let [x, y, z, w] = orientation(&UnitQuaternion::identity());
    let half = core::f64::consts::FRAC_1_SQRT_2;
    let sign = w.signum();
    for (found, wanted) in [(x, 0.0), (y, 0.0), (z, half), (w, half)] {
        assert!((sign * found - wanted).abs() < 1e-15, "{found} {wanted}");
    }
}

#[test]
fn an_attitude_and_its_vectors_turn_alike() {
    let q_nb = exp(&Vector3::new(0.4, -0.3, 2.0));
    let in_b = [0.3, -1.2, 9.0];
    let in_n: [f64; 3] = (q_nb * Vector3::from(in_b)).into();
    let [x, y, z, w] = orientation(&q_nb);
    let turned =
        UnitQuaternion::new_unchecked(Quaternion::new(w, x, y, z)) * Vector3::from(flu(in_b));
    assert!((turned - Vector3::from(enu(in_n))).norm() < 1e-12);
}
