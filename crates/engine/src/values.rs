//! The model's own values as handles: for native states and tests.

use crate::Datum;
use rafcon_model::{Answer, DataType, Value};
use smol_str::SmolStr;

impl Datum for Value {
    fn none() -> Self {
        Self::None
    }

    fn is_none(&self) -> bool {
        Self::is_none(self)
    }

    fn fits(&self, data_type: &DataType) -> Answer {
        let Some(own) = DataType::of(self) else { return Answer::Unknown };
        match (&own, data_type) {
            (DataType::None, _)
            | (_, DataType::None | DataType::Object)
            | (DataType::Int | DataType::Bool, DataType::Int | DataType::Float)
            | (DataType::Float, DataType::Int) => Answer::Yes,
            (_, DataType::Named(_)) => Answer::Unknown,
            (own, declared) if *own == *declared => Answer::Yes,
            _ => Answer::No,
        }
    }

    fn type_name(&self) -> SmolStr {
        DataType::of(self).map_or_else(|| "object".into(), |own| own.short_name())
    }
}
