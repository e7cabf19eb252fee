//! One message of a recording, decoded.

use super::event::Event;
use super::message::{self, MessageError, Topic};
use octant_sample::parameters::ParameterEstimate;
use octant_sample::{Aiding, Innovation, NavigationCovariance, Output, Sample, Truth};

/// One message of a recording.
#[derive(Clone, Debug, PartialEq)]
pub enum Item {
    /// Sample that the source delivered, if it differs from the one that reached the core.
    CleanSample(Sample),
    /// Aiding that the source delivered, if it differs from that which reached the core.
    CleanAiding(Option<Aiding>),
    /// Aiding that reached the core.
    Aiding(Aiding),
    /// A sample that reached the core.
    Sample(Sample),
    /// An output of the core.
    Output(Output),
    /// Innovation with the sequence number of its epoch.
    Innovation(u64, Innovation),
    /// Covariance of the solution with the sequence number of its epoch.
    Covariance(u64, NavigationCovariance),
    /// Parameters with the sequence number of their epoch.
    Parameters(u64, Box<ParameterEstimate>),
    /// Truth.
    Truth(Truth),
    /// An event.
    Event(Event),
}

impl Item {
    pub(super) fn decode(topic: Topic, data: &[u8]) -> Result<Self, MessageError> {
        Ok(match topic {
            Topic::ImuClean => Self::CleanSample(message::decode_sample(data)?),
            Topic::Imu => Self::Sample(message::decode_sample(data)?),
            Topic::AidingClean => Self::CleanAiding(message::decode_aiding(data)?),
            Topic::Aiding => match message::decode_aiding(data)? {
                Some(aiding) => Self::Aiding(aiding),
                None => {
                    return Err(MessageError::Value {
                        field: "kind",
                        found: 255,
                        expected: "0 (velocity) or 1 (position)",
                    });
                }
            },
            Topic::Output => Self::Output(message::decode_output(data)?),
            Topic::Innovation => {
                let (sequence, innovation) = message::decode_innovation(data)?;
                Self::Innovation(sequence, innovation)
            }
            Topic::Covariance => {
                let (sequence, covariance) = message::decode_covariance(data)?;
                Self::Covariance(sequence, covariance)
            }
            Topic::Parameters => {
                let (sequence, estimate) = message::decode_parameters(data)?;
                Self::Parameters(sequence, Box::new(estimate))
            }
            Topic::Truth => Self::Truth(message::decode_truth(data)?),
            Topic::Event => Self::Event(
                serde_json::from_slice(data)
                    .map_err(|error| MessageError::Json { reason: error.to_string() })?,
            ),
        })
    }

    /// Topic of the message.
    #[must_use]
    pub const fn topic(&self) -> Topic {
        match self {
            Self::CleanSample(_) => Topic::ImuClean,
            Self::CleanAiding(_) => Topic::AidingClean,
            Self::Aiding(_) => Topic::Aiding,
            Self::Sample(_) => Topic::Imu,
            Self::Output(_) => Topic::Output,
            Self::Innovation(..) => Topic::Innovation,
            Self::Covariance(..) => Topic::Covariance,
            Self::Parameters(..) => Topic::Parameters,
            Self::Truth(_) => Topic::Truth,
            Self::Event(_) => Topic::Event,
        }
    }
}
