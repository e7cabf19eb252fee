//! Stepping orders as text.

use octant_cosim::order::SteppingOrder;

#[test]
fn an_order_is_written_and_read() {
    let names = ["plant", "ship", "calibrator"];
    assert_eq!("jacobi".parse::<SteppingOrder>().unwrap().of(&names).unwrap(), [0, 1, 2]);
    let order: SteppingOrder = "gauss-seidel=calibrator, plant,ship".parse().unwrap();
    assert_eq!(order.of(&names).unwrap(), [2, 0, 1]);
    assert_eq!(order.to_string().parse::<SteppingOrder>().unwrap(), order);
    for (text, expected) in [
        ("gauss-seidel=plant,ship", "leaves out calibrator"),
        ("gauss-seidel=plant,ship,ship,calibrator", "twice"),
        ("gauss-seidel=plant,ship,calibrater", "did you mean \"calibrator\"?"),
    ] {
        let error = text.parse::<SteppingOrder>().unwrap().of(&names).unwrap_err();
        assert!(error.to_string().contains(expected), "{error}");
    }
    for text in ["", "gauss", "gauss-seidel=", "gauss-seidel=a,,b", "Jacobi"] {
        assert!(text.parse::<SteppingOrder>().is_err(), "{text}");
    }
}
