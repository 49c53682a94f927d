//! Questions that states ask people.

use serde::{Deserialize, Serialize};

/// A question of a state. It is open until it is answered or times out, or until its state is preempted.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
pub struct Question {
    /// Unique in the run.
    pub id: u64,
    /// The state that asks.
    pub path: String,
    /// Text of the question.
    pub message: String,
    /// Form of the answer.
    pub form: Form,
    /// Timeout, in ms from the moment of the question. `None` for no timeout.
    #[serde(default)]
    pub timeout_ms: Option<u64>,
    /// Time that the ground may be silent, in ms. After it the question closes as if it timed out.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub lost_link_ms: Option<u64>,
    /// Answer on timeout, in the shape that `form` defines.
    #[serde(default)]
    pub default: Option<serde_json::Value>,
}

/// Form of the answer to a question.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(tag = "type", rename_all = "snake_case")]
pub enum Form {
    /// A choice of buttons. The answer is `{"button": index}`.
    Buttons {
        /// Labels of the buttons, from the left.
        buttons: Vec<String>,
    },
    /// A line of text, ended by a button. The answer is `{"button": index, "text": text}`.
    Text {
        /// Labels of the buttons.
        buttons: Vec<String>,
        /// Initial text of the line.
        #[serde(default)]
        initial: String,
    },
    /// A number. The answer is `{"button": index, "number": number}`.
    Number {
        /// Labels of the buttons.
        buttons: Vec<String>,
        /// Smallest number that is accepted.
        #[serde(default)]
        minimum: Option<f64>,
        /// Largest number that is accepted.
        #[serde(default)]
        maximum: Option<f64>,
        /// Initial number in the field.
        #[serde(default)]
        initial: Option<f64>,
        /// True to accept whole numbers only.
        #[serde(default)]
        whole: bool,
    },
    /// Boxes to tick. The answer is `{"button": index, "checked": [bool]}`.
    Checks {
        /// Labels of the buttons.
        buttons: Vec<String>,
        /// Labels of the boxes.
        boxes: Vec<String>,
        /// Initial state of each box.
        #[serde(default)]
        initial: Vec<bool>,
    },
}

/// Reason why a question was closed.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Serialize, Deserialize)]
#[cfg_attr(feature = "schema", derive(utoipa::ToSchema, ts_rs::TS))]
#[serde(rename_all = "snake_case")]
pub enum Closing {
    /// A user answered it.
    Answered,
    /// The timeout expired. The default is the answer.
    TimedOut,
    /// Its state was preempted or ended, or the run ended.
    Withdrawn,
}
