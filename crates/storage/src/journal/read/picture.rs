//! A moment with names and values, for people and programs without Python. Combines moments and values.

use super::Reader;
use super::event::{name_of, outcome_of};
use crate::journal::folder::JournalError;
use crate::journal::moment::{ActiveStateData, ChildEnd, Moment, ScopedValue};
use crate::journal::record::Kept;
use rafcon_protocol::Values;
use rafcon_protocol::api::{self, MomentEnd, MomentState};
use smol_str::SmolStr;

type FoundValues<T> = Result<T, JournalError>;

impl Reader {
    /// Returns the moment with names and values.
    pub fn picture(&self, moment: &Moment) -> FoundValues<api::Moment> {
        let whole = moment.whole();
        let standing = moment.active();
        let mut depths: Vec<usize> = Vec::with_capacity(standing.len());
        for state in &standing {
            depths.push(state.parent.map_or(0, |parent| depths[parent] + 1));
        }
        let active = standing.iter().zip(&depths).map(|(state, depth)| self.state(state, *depth));
        let named = |(name, value): (&SmolStr, &Kept)| Ok((name.to_string(), self.view(value)?));
        let globals = moment.globals().iter().map(named).collect::<FoundValues<Values>>()?;
        let persistent =
            moment.persistent().map(|(place, value)| Ok((place.path.clone(), self.view(value)?)));
        Ok(api::Moment {
            sequence: moment.sequence(),
            t_ns: moment.t_ns(),
            status: whole.status,
            outcome: whole.outcome.clone(),
            root: whole.root.clone(),
            life: whole.life,
            states_run: moment.states_run(),
            active: active.collect::<FoundValues<_>>()?,
            held: whole.held.clone(),
            waiting: whole.waiting.clone(),
            globals,
            persistent: persistent.collect::<FoundValues<Values>>()?,
            breakpoints: whole.breakpoints.values().cloned().collect(),
            questions: whole.questions.values().cloned().collect(),
        })
    }

    fn state(&self, state: &ActiveStateData, depth: usize) -> FoundValues<MomentState> {
        let scoped = |variable: &ScopedValue| {
            let name = name_of(Some(&state.place.scoped), variable.port);
            Ok((name, self.view(&variable.value)?))
        };
        Ok(MomentState {
            path: state.place.path.clone(),
            names: state.place.names.clone(),
            depth,
            entered: state.order,
            since_ns: state.since_ns,
            inputs: self.by_name(&state.place.inputs, &state.inputs, state.lacks_inputs)?,
            scoped: state.scoped.iter().map(scoped).collect::<FoundValues<_>>()?,
            ended: state.ended.iter().map(|end| self.end(end)).collect::<FoundValues<_>>()?,
        })
    }

    fn end(&self, end: &ChildEnd) -> FoundValues<MomentEnd> {
        Ok(MomentEnd {
            path: end.place.path.clone(),
            names: end.place.names.clone(),
            outcome: outcome_of(Some(&end.place), end.outcome),
            outputs: self.by_name(&end.place.outputs, &end.outputs, end.lacks_outputs)?,
            error: end.error.as_ref().map(|error| self.view(error)).transpose()?,
            sequence: end.order,
        })
    }

    fn by_name(
        &self,
        ports: &[(u64, SmolStr)],
        values: &[(u64, Kept)],
        lacking: bool,
    ) -> FoundValues<Option<Values>> {
        if lacking {
            return Ok(None);
        }
        let named =
            values.iter().map(|(port, value)| Ok((name_of(Some(ports), *port), self.view(value)?)));
        named.collect::<FoundValues<Values>>().map(Some)
    }
}
