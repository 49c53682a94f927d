//! What a state asks people.

use serde::{Deserialize, Serialize};

/// A question of a state. It stays open until it is answered, its time is over, or its state is preempted.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Question {
    /// Unique in the run.
    pub id: u64,
    /// The state that asks.
    pub path: String,
    /// The text.
    pub message: String,
    /// How it is answered.
    pub form: Form,
    /// Time to answer from the moment it is asked, in ms; `None`: as long as it takes.
    #[serde(default)]
    pub timeout_ms: Option<u64>,
    /// Time that the ground may be silent, in ms; then the question closes as if its time were over.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lost_link_ms: Option<u64>,
    /// The answer when the time is over: of the shape that `form` says.
    #[serde(default)]
    pub default: Option<serde_json::Value>,
}

/// How a question is answered.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Form {
    /// One of some buttons; the answer is `{"button": index}`.
    Buttons {
        /// Their labels, from the left.
        buttons: Vec<String>,
    },
    /// A line of text, ended by a button; the answer is `{"button": index, "text": text}`.
    Text {
        /// Labels of the buttons.
        buttons: Vec<String>,
        /// What stands in the line at first.
        #[serde(default)]
        initial: String,
    },
    /// A number; the answer is `{"button": index, "number": number}`.
    Number {
        /// Labels of the buttons.
        buttons: Vec<String>,
        /// The smallest that is taken.
        #[serde(default)]
        minimum: Option<f64>,
        /// The largest that is taken.
        #[serde(default)]
        maximum: Option<f64>,
        /// What stands there at first.
        #[serde(default)]
        initial: Option<f64>,
        /// Whether only whole numbers are taken.
        #[serde(default)]
        whole: bool,
    },
    /// Boxes to tick; the answer is `{"button": index, "checked": [bool]}`.
    Checks {
        /// Labels of the buttons.
        buttons: Vec<String>,
        /// Labels of the boxes.
        boxes: Vec<String>,
        /// Which are ticked at first.
        #[serde(default)]
        initial: Vec<bool>,
    },
}

/// How a question came to its end.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum Closing {
    /// Someone answered.
    Answered,
    /// The time was over; the default counts.
    TimedOut,
    /// Its state was preempted or the run ended.
    Withdrawn,
}
