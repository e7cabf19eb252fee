//! Keys of a device at the other end of a wire.

use super::table::{At, Of, keys, time};

const fn wait() -> Of<f64> {
    time(1e-3, 3600.0, "from 1 ms to 1 h")
}

keys! {
    /// `[endpoint.link]`.
    pub(crate) struct LinkKeys {
        hello: f64 = wait(), "10 s",
            "How long the device's first hello is waited for, such as while it is switched on.";
        answer: f64 = wait(), "5 s",
            "How long an answer is waited for, however often it is asked for; then the device is gone.";
        repeat: At<f64> = wait(), "200 ms",
            "After how long an answer that isn't there is asked for again.";
        reconnect: At<f64> = time(0.0, 3600.0, "from 0 s to 1 h"), "0 s",
            "How long a port that was unplugged is waited for; the device has to have kept its state. 0 s: the run ends at once.";
    }
}
