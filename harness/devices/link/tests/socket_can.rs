//! Frames of the kernel, and what an interface reports.

use octant_link::Uri;
use octant_link::port::socket_can::{compare, event, filters, trouble};
use octant_link::port::{BusEvent, BusTrouble, SocketCan};
use octant_wire::EndRole;
use octant_wire::can::{Bus, BusFrame, CanVersion, Slot};
use socketcan::{CanAnyFrame, CanDataFrame, CanErrorFrame, CanFdFrame, EmbeddedFrame, StandardId};

fn error_frame(bits: u32, controller: u8) -> BusTrouble {
    let frame = CanErrorFrame::new_error(bits, &[0, controller, 0, 0, 0, 0, 0, 0]).unwrap();
    trouble(&frame)
}

#[test]
fn an_error_frame_is_the_worst_that_it_says() {
    assert_eq!(error_frame(0x40, 0), BusTrouble::Off);
    assert_eq!(error_frame(0x04, 0x20), BusTrouble::Passive);
    // Error frames as the sja1000 driver reports them: protocol violation, bus error and controller
    // in one frame.
    assert_eq!(error_frame(0x8C, 0x10), BusTrouble::Passive);
    assert_eq!(error_frame(0x8C, 0x08), BusTrouble::Warning);
    assert_eq!(error_frame(0x88, 0x10), BusTrouble::ErrorFrame);
    assert_eq!(error_frame(0x02, 0), BusTrouble::ArbitrationLost);
    assert_eq!(error_frame(0x20, 0), BusTrouble::NotAcknowledged);
    assert_eq!(error_frame(0x100, 0), BusTrouble::Restarted);
    assert_eq!(error_frame(0x04, 0x01), BusTrouble::Overrun);
}

#[test]
fn a_frame_becomes_the_kernel_s_and_is_itself_again() {
    let id = StandardId::new(0x2C3).unwrap();
    let classic = CanAnyFrame::Normal(CanDataFrame::new(id, &[1, 2, 3]).unwrap());
    let expected = BusFrame::new(0x2C3, CanVersion::Classic, &[1, 2, 3]).unwrap();
    assert_eq!(event(&classic), BusEvent::Frame(expected));
    let fd = CanAnyFrame::Fd(CanFdFrame::new(id, &[7; 12]).unwrap());
    let expected = BusFrame::new(0x2C3, CanVersion::Fd, &[7; 12]).unwrap();
    assert_eq!(event(&fd), BusEvent::Frame(expected));
    let extended = socketcan::ExtendedId::new(0x2C3).unwrap();
    let foreign = CanAnyFrame::Normal(CanDataFrame::new(extended, &[1]).unwrap());
    assert_eq!(event(&foreign), BusEvent::Trouble(BusTrouble::Foreign));
}

#[test]
fn rates_that_differ_are_told() {
    let uri: Uri = "can:can0?bitrate=500000".parse().unwrap();
    let Uri::Can(can) = uri else { panic!() };
    assert!(compare(&can, None).is_ok());
    assert!(compare(&can, Some(Bus::classic(500_000))).is_ok());
    let told = compare(&can, Some(Bus::classic(250_000))).unwrap_err().to_string();
    assert_eq!(
        told,
        "open can:can0?fd=0&bitrate=500000: the interface has bitrate 250000, expected 500000"
    );
}

#[test]
fn each_end_hears_the_other() {
    let heard = |role| filters(role, CanVersion::Classic).len();
    assert_eq!(heard(EndRole::Device), 8);
    assert_eq!(heard(EndRole::Harness), Slot::ALL.len() - 8);
}

#[test]
fn an_interface_that_isn_t_there_is_named() {
    let Uri::Can(can) = "can:octant9".parse().unwrap() else { panic!() };
    let error = SocketCan::open(&can, EndRole::Harness).unwrap_err().to_string();
    assert!(error.contains("can:octant9") && error.contains("no such interface"), "{error}");
}
