//! The model of RAFCON: a state machine as an immutable value.
//!
//! Knows states, ports, outcomes, transitions, data flows, values, types, validity rules and edits.
//! Knows nothing of files, threads, time or Python.

mod conflict;
pub mod connection;
mod convert;
pub mod data_flows;
pub mod diff;
pub mod edit;
pub mod history;
pub mod ids;
pub mod json;
pub mod literal;
pub mod lost_link;
pub mod machine;
pub mod notation;
pub mod port;
pub mod problems;
pub mod rules;
pub mod sorted;
pub mod state;
pub mod transitions;
pub mod types;
pub mod value;

pub use conflict::{CONFLICT_REMEDY, conflict_line};
pub use connection::{DataFlow, Origin, Target, Transition};
pub use convert::{Conversion, convert, convert_runtime_value};
pub use data_flows::DataFlows;
pub use diff::{Aspect, Difference, diff};
pub use history::History;
pub use ids::{DECIDER_ID, DataFlowId, Fresh, OutcomeId, PortId, StateId, StatePath, TransitionId};
pub use json::Json;
pub use lost_link::{Loss, LossPolicy, seconds_as_ms};
pub use machine::{Header, Machine};
pub use port::{Outcome, Outcomes, Port, Ports};
pub use problems::{Problem, problems};
pub use rules::{Part, PortKind, Rule, Severity};
pub use sorted::Sorted;
pub use state::{
    Container, Kind, KindName, Layout, Library, LibraryContent, RuntimeValue, RuntimeValues,
    Script, State, States,
};
pub use transitions::Transitions;
pub use types::{Answer, BuiltinTypes, DataType, Types};
pub use value::Value;
