//! An instrument over UDP as a source: frames in any pieces, and pieces that are lost.

use super::unit_frames::{FRAME, all, check, frame};
use octant_instruments::{Axes, Protocol};
use octant_sample::GimbalCommand;
use octant_scenario::{DescriptionChoice, FileName, Instrument, Speaks};
use octant_source::{Epoch, LiveSource, Source};
use std::net::UdpSocket;
use std::path::Path;

fn open(speaks: Speaks, folder: &Path) -> (LiveSource, UdpSocket) {
    let instrument = Instrument {
        uri: "udp:127.0.0.1:0".parse().unwrap(),
        speaks,
        count: None,
        axes: Axes::SAME,
        silence_s: 0.3,
        pulses: None,
        known_stamps: None,
    };
    let source = LiveSource::open(&instrument, folder, 200.0, None).unwrap();
    let socket = UdpSocket::bind("127.0.0.1:0").unwrap();
    socket.connect(source.reached_at().strip_prefix("udp:").unwrap()).unwrap();
    (source, socket)
}

fn vectornav() -> (LiveSource, UdpSocket) {
    open(Speaks::Bytes(Protocol::VectorNav), Path::new(""))
}

#[test]
fn a_frame_split_at_every_offset_is_read() {
    let (mut source, socket) = vectornav();
    for (number, cut) in (1..).zip(1..FRAME) {
        let frame = frame(number);
        socket.send(&frame[..cut]).unwrap();
        socket.send(&frame[cut..]).unwrap();
    }
    let (found, said) = all(&mut source);
    check(&found, &(1..FRAME as u64).collect::<Vec<_>>());
    assert!(said.contains("41 readings, 0 other frames"), "{said}");
    assert!(said.ends_with("0 frames with a wrong checksum"), "{said}");
}

#[test]
fn pieces_of_any_length_and_several_frames_in_a_datagram_are_read() {
    let numbers: Vec<u64> = (1..=60).collect();
    let stream: Vec<u8> = numbers.iter().flat_map(|number| frame(*number)).collect();
    // Pieces of a byte; a third of a frame; two frames and a half; one and a part.
    for piece in [1, 14, 105, 47] {
        let (mut source, socket) = vectornav();
        let mut found = Vec::new();
        let mut epoch = Epoch::default();
        let mut sent = 0;
        for piece in stream.chunks(piece) {
            socket.send(piece).unwrap();
            sent += piece.len();
            // The kernel keeps a few hundred datagrams, and drops others.
            while found.len() < sent / FRAME {
                assert!(source.next(&GimbalCommand::default(), &mut epoch).unwrap());
                found.push(epoch.sample);
            }
        }
        check(&found, &numbers);
    }
    // More than a page: nothing of a datagram is cut off.
    let (mut source, socket) = vectornav();
    let numbers: Vec<u64> = (1..=1500).collect();
    let stream: Vec<u8> = numbers.iter().flat_map(|number| frame(*number)).collect();
    socket.send(&stream).unwrap();
    check(&all(&mut source).0, &numbers);
}

#[test]
fn a_lost_piece_costs_its_frame_alone_and_is_counted() {
    for cut in 1..FRAME {
        for lost in [0, 1] {
            let (mut source, socket) = vectornav();
            for number in 1..=6 {
                let frame = frame(number);
                let pieces = [&frame[..cut], &frame[cut..]];
                for (index, piece) in pieces.into_iter().enumerate() {
                    if (number, index) != (3, lost) {
                        socket.send(piece).unwrap();
                    }
                }
            }
            let mut epoch = Epoch::default();
            let mut found = Vec::new();
            for _ in 0..5 {
                assert!(source.next(&GimbalCommand::default(), &mut epoch).unwrap());
                found.push(epoch.sample);
            }
            check(&found, &[1, 2, 4, 5, 6]);
            let told = source.conclude(None).0.unwrap();
            assert_eq!((told.readings.samples, told.readings.missing), (5, 1), "{cut} {lost}");
            let bytes = 6 * FRAME - if lost == 0 { cut } else { FRAME - cut };
            let expected = format!(": {bytes} bytes, 5 readings, 0 other frames of protocol");
            assert!(told.instrument.contains(&expected), "{}", told.instrument);
            let left = bytes - 5 * FRAME;
            let bytes = if left == 1 { "byte belongs" } else { "bytes belong" };
            let expected = format!("; {left} {bytes} to no frame of this protocol");
            assert!(told.instrument.ends_with(&expected), "{expected}: {}", told.instrument);
        }
    }
}

#[test]
fn a_frame_without_a_checksum_is_never_made_of_two() {
    let folder = tempfile::tempdir().unwrap();
    let fields: Vec<String> = ["gyro x", "gyro y", "gyro z", "accel x", "accel y", "accel z"]
        .iter()
        .enumerate()
        .map(|(index, is)| {
            let (at, unit) = (4 + 4 * index, if index < 3 { "rad" } else { "m/s" });
            format!(r#"{{ is = "{is}", at = {at}, type = "f32", unit = "{unit}" }}"#)
        })
        .collect();
    let text = format!(
        "version = 1\nname = \"a unit\"\nchecksum = {{ kind = \"none\" }}\n[[frame]]\nsync = [0xA5, 0x5A]\nlength = 28\n\
         field = [{{ is = \"counter\", at = 2, type = \"u16\" }}, {}]\n",
        fields.join(", ")
    );
    std::fs::write(folder.path().join("unit.toml"), text).unwrap();
    let speaks = Speaks::Described(DescriptionChoice::File(FileName("unit.toml".to_owned())));
    let (mut source, socket) = open(speaks, folder.path());
    let frame = |number: u16| -> Vec<u8> {
        let mut bytes = vec![0xA5, 0x5A];
        bytes.extend(number.to_le_bytes());
        (1..=6).for_each(|k| bytes.extend((1e-4 * f32::from(number * k)).to_le_bytes()));
        bytes
    };
    // The rest of the second frame is lost; the rest of the fourth comes, and is refused all the same.
    for piece in [&frame(1)[..], &frame(2)[..20], &frame(3), &frame(4)[..12], &frame(4)[12..]] {
        socket.send(piece).unwrap();
    }
    socket.send(&[frame(5), frame(6)].concat()).unwrap();
    let (found, said) = all(&mut source);
    let numbers: Vec<u64> = found.iter().map(|sample| sample.sequence).collect();
    assert_eq!(numbers, [1, 3, 5, 6]);
    for (sample, number) in found.iter().zip([1_u16, 3, 5, 6]) {
        let sent = f64::from(1e-4 * f32::from(number)) * 2f64.powi(36);
        assert!((f64::from(sample.delta_theta[0]) - sent).abs() <= 1.0, "{number}");
    }
    assert!(said.contains("160 bytes, 4 readings"), "{said}");
}
