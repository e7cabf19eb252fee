//! The seal of datagrams, without a port.

use octant_link::port::seal::{OpenedSeal, SEAL_LEN, Seal, SealEnd};

const SECRET: &[u8] = b"sixteen bytes or more";

fn sealed(seal: &mut Seal, frames: &[u8]) -> Vec<u8> {
    let mut datagram = frames.to_vec();
    datagram.resize(frames.len() + SEAL_LEN, 0);
    seal.seal(&mut datagram);
    datagram
}

/// Two ends that have met.
fn met() -> (Seal, Seal) {
    let mut harness = Seal::new(SealEnd::Harness, SECRET).unwrap();
    let mut device = Seal::new(SealEnd::Device, SECRET).unwrap();
    let first = sealed(&mut harness, b"hello");
    assert_eq!(device.open(&first), OpenedSeal::Unknown);
    assert_eq!(harness.open(&device.challenge(&first)), OpenedSeal::Learnt);
    assert_eq!(device.open(&sealed(&mut harness, b"hello")), OpenedSeal::Frames(5));
    assert_eq!(harness.open(&sealed(&mut device, b"hi")), OpenedSeal::Frames(2));
    (harness, device)
}

/// Bytes by Python's `hmac`, the same by `openssl dgst -sha256 -hmac`: the example of the wire's page.
#[test]
fn a_seal_of_another_implementation_opens() {
    let page = include_str!("../../wire/README.md");
    let hex = "0102030400 2021222324252627 0700000000000000 f20a10e60ec0c8b4ba41b0eed305fc44";
    assert!(page.contains(hex));
    let hex = hex.replace(' ', "");
    let bytes: Vec<u8> = (0..hex.len())
        .step_by(2)
        .map(|i| u8::from_str_radix(&hex[i..i + 2], 16).unwrap())
        .collect();
    let next = std::array::from_fn(|i| 0x10 + i as u8);
    let mut device = Seal::with_nonces(SealEnd::Device, SECRET, [0; 8], next).unwrap();
    assert_eq!(device.open(&bytes), OpenedSeal::Frames(5));
}

#[test]
fn each_datagram_counts_once_in_any_order() {
    let (mut harness, mut device) = met();
    let all: Vec<Vec<u8>> = (0..200_u8).map(|i| sealed(&mut harness, &[i, 0])).collect();
    for pair in all.chunks(2) {
        assert_eq!(device.open(&pair[1]), OpenedSeal::Frames(2));
        assert_eq!(device.open(&pair[0]), OpenedSeal::Frames(2));
        assert_eq!(device.open(&pair[0]), OpenedSeal::Dropped);
    }
    for datagram in &all {
        assert_eq!(device.open(datagram), OpenedSeal::Dropped);
    }
}

#[test]
fn no_changed_byte_and_no_other_secret_opens() {
    let (mut harness, mut device) = met();
    let datagram = sealed(&mut harness, b"frames");
    for at in 0..datagram.len() {
        let mut changed = datagram.clone();
        changed[at] ^= 1;
        assert!(!matches!(device.open(&changed), OpenedSeal::Frames(_)), "byte {at}");
    }
    for short in 0..datagram.len() {
        assert!(!matches!(device.open(&datagram[..short]), OpenedSeal::Frames(_)));
    }
    // What an end says isn't taken back by it, nor by an end of its kind.
    assert_eq!(harness.open(&datagram), OpenedSeal::Dropped);
    let mut other = Seal::new(SealEnd::Harness, b"sixteen bytes or less").unwrap();
    assert_eq!(other.open(&device.challenge(&datagram)), OpenedSeal::Dropped);
    assert_eq!(device.open(&sealed(&mut other, b"frames")), OpenedSeal::Unknown);
    assert_eq!(device.open(&datagram), OpenedSeal::Frames(6));
    assert!(Seal::new(SealEnd::Device, b"fifteen bytes..").is_none());
}

#[test]
fn nothing_of_an_earlier_session_begins_another() {
    let (mut harness, mut device) = met();
    let mut heard = vec![sealed(&mut harness, b"sample"), sealed(&mut harness, b"bye")];
    assert_eq!(device.open(&heard[0]), OpenedSeal::Frames(6));
    // The harness starts anew.
    let mut second = Seal::new(SealEnd::Harness, SECRET).unwrap();
    let first = sealed(&mut second, b"hello");
    assert_eq!(device.open(&first), OpenedSeal::Unknown);
    let challenge = device.challenge(&first);
    assert_eq!(second.open(&challenge), OpenedSeal::Learnt);
    let hello = sealed(&mut second, b"hello");
    assert_eq!(device.open(&hello), OpenedSeal::Frames(5));
    heard.extend([first, hello]);
    for datagram in &heard {
        assert!(!matches!(device.open(datagram), OpenedSeal::Frames(_)));
    }
    assert_eq!(second.open(&challenge), OpenedSeal::Dropped);
    // The device starts anew: what it said before is nothing now, and what was said to it neither.
    let old = sealed(&mut device, b"answer");
    let mut device = Seal::new(SealEnd::Device, SECRET).unwrap();
    let sample = sealed(&mut second, b"sample");
    assert_eq!(device.open(&sample), OpenedSeal::Unknown);
    assert_eq!(second.open(&device.challenge(&sample)), OpenedSeal::Learnt);
    assert_eq!(second.open(&old), OpenedSeal::Dropped);
    assert_eq!(device.open(&sealed(&mut second, b"sample")), OpenedSeal::Frames(6));
    assert_eq!(second.open(&sealed(&mut device, b"started anew")), OpenedSeal::Frames(12));
}
