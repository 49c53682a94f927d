//! Questions of states to people. A question is open until it is answered, its time is over, or its state ends. This
//! module knows who waits for an answer, but not how people see a question.

use crate::drive::error::QuestionError;
use crate::places::signals::PREEMPTED;
use crate::{Clock, Driver, Place, Scripts};
use rafcon_engine::PathId;
use rafcon_locks::{Condvar, Mutex};
use rafcon_protocol::{Closing, Event, Form, Question};
use serde_json::Value;
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use std::time::{Duration, Instant};

/// A question of a script, with its limits.
#[derive(Debug, Clone, PartialEq)]
pub struct Asked {
    /// Text of the question.
    pub message: String,
    /// The form of the answer.
    pub form: Form,
    /// Time to answer, in ms; `None` for no limit.
    pub timeout_ms: Option<u64>,
    /// Silence of the ground, in ms, after which the question closes as if its time were over.
    pub lost_link_ms: Option<u64>,
    /// The answer if the time is over.
    pub default: Option<Value>,
}

/// The result of a question.
#[derive(Debug, Clone, PartialEq)]
pub struct Closed {
    /// The reason why the question closed.
    pub how: Closing,
    /// The answer, or the default; `None` if neither exists.
    pub answer: Option<Value>,
}

/// The questions of a run.
#[derive(Debug, Default)]
pub(crate) struct Questions {
    /// Number of open questions. It is mostly 0, and then no lock is needed.
    count: AtomicUsize,
    list: Mutex<List>,
    closed: Condvar,
}

#[derive(Debug, Default)]
struct List {
    /// The number of the last question.
    last: u64,
    open: BTreeMap<u64, Open>,
    /// True if the run is over and new questions are withdrawn at once.
    over: bool,
}

#[derive(Debug)]
struct Open {
    question: Question,
    place: Arc<Place>,
    /// The result. The first one is final.
    end: Option<QuestionEnd>,
}

#[derive(Debug)]
struct QuestionEnd {
    closed: Closed,
    author: String,
}

impl<S: Scripts> Driver<S> {
    /// Asks people, and waits for the end of the question. Called on the thread of the state's script, which leaves the
    /// interpreter meanwhile.
    pub fn ask(&self, place: &Arc<Place>, asked: Asked) -> Result<Closed, QuestionError> {
        asked.form.check().map_err(QuestionError::Form)?;
        if let Some(default) = &asked.default {
            asked.form.takes(default).map_err(QuestionError::Default)?;
        }
        let timeout = asked.timeout_ms.map(Duration::from_millis);
        let question = self.questions().open(place, asked);
        let id = question.id;
        let waits_for_ground = question.lost_link_ms.is_some();
        self.record().tell(Event::Asked { question: Box::new(question) });
        if waits_for_ground {
            self.look_at_ground_later();
        }
        let mut end = None;
        let deadline = timeout.and_then(Clock::moment);
        self.scripts().park(&mut || end = Some(self.questions().wait(id, deadline)));
        let QuestionEnd { closed, author } = end.unwrap_or_else(withdrawn);
        let (how, answer) = (closed.how, closed.answer.clone());
        self.record().tell(Event::Closed { id, how, answer, author });
        Ok(closed)
    }
}

impl Questions {
    /// Continues the numbers of questions after this one.
    pub(crate) fn go_on_after(&self, last: u64) {
        self.list.lock().last = last;
    }

    /// Closes a question with an answer; the first one counts.
    pub(crate) fn answer(
        &self,
        id: u64,
        answer: &Value,
        author: &str,
    ) -> Result<(), QuestionError> {
        let mut list = self.list.lock();
        let last = list.last;
        let Some(open) = list.open.get_mut(&id).filter(|open| open.end.is_none()) else {
            let is_closed = id > 0 && id <= last;
            return Err(if is_closed {
                QuestionError::Closed(id)
            } else {
                QuestionError::Unknown(id)
            });
        };
        open.question.form.takes(answer).map_err(QuestionError::Answer)?;
        let closed = Closed { how: Closing::Answered, answer: Some(answer.clone()) };
        open.end = Some(QuestionEnd { closed, author: author.to_owned() });
        self.closed.notify_all();
        Ok(())
    }

    /// Unanswered questions, in the order of their ids.
    pub(crate) fn unanswered(&self) -> Vec<Question> {
        let list = self.list.lock();
        let open = list.open.values().filter(|open| open.end.is_none());
        open.map(|open| open.question.clone()).collect()
    }

    /// Withdraws the questions of the state at this place, which is asked to end.
    pub(crate) fn withdraw(&self, path: PathId) {
        self.withdraw_if(|place| place.path == path);
    }

    /// Withdraws the questions of states that are no longer active.
    pub(crate) fn withdraw_orphans(&self) {
        if self.count.load(Ordering::Relaxed) == 0 {
            return;
        }
        self.withdraw_if(|place| !place.is_active());
    }

    /// The times of silence that open questions name, in ms.
    pub(crate) fn silences(&self) -> Vec<u64> {
        if self.count.load(Ordering::Relaxed) == 0 {
            return Vec::new();
        }
        let list = self.list.lock();
        list.open.values().filter_map(|open| open.question.lost_link_ms).collect()
    }

    /// Closes the questions whose time of silence is reached, for a ground that was silent for `silent_ms`.
    pub(crate) fn give_up(&self, silent_ms: u64) {
        let mut list = self.list.lock();
        let unanswered = list.open.values_mut().filter(|open| open.end.is_none());
        for open in unanswered.filter(|open| {
            open.question.lost_link_ms.is_some_and(|ms| silent_ms > 0 && silent_ms >= ms)
        }) {
            open.end = Some(timed_out(&open.question));
            self.closed.notify_all();
        }
    }

    /// Withdraws all questions, because the run is over.
    pub(crate) fn end(&self) {
        self.list.lock().over = true;
        self.withdraw_if(|_| true);
    }

    fn withdraw_if(&self, wanted: impl Fn(&Place) -> bool) {
        let mut list = self.list.lock();
        let unanswered = list.open.values_mut().filter(|open| open.end.is_none());
        for open in unanswered.filter(|open| wanted(&open.place)) {
            open.end = Some(withdrawn());
            self.closed.notify_all();
        }
    }

    fn open(&self, place: &Arc<Place>, asked: Asked) -> Question {
        let Asked { message, form, timeout_ms, lost_link_ms, default } = asked;
        let mut list = self.list.lock();
        list.last += 1;
        let (id, path) = (list.last, place.text.to_string());
        let question = Question { id, path, message, form, timeout_ms, lost_link_ms, default };
        let end = (list.over || place.signals.any(PREEMPTED)).then(withdrawn);
        self.count.fetch_add(1, Ordering::Relaxed);
        list.open.insert(id, Open { question: question.clone(), place: Arc::clone(place), end });
        question
    }

    fn wait(&self, id: u64, deadline: Option<Instant>) -> QuestionEnd {
        let mut list = self.list.lock();
        while list.open.get(&id).is_some_and(|open| open.end.is_none()) {
            let Some(deadline) = deadline else {
                self.closed.wait(&mut list);
                continue;
            };
            if self.closed.wait_until(&mut list, deadline).timed_out() {
                break;
            }
        }
        self.count.fetch_sub(1, Ordering::Relaxed);
        list.open
            .remove(&id)
            .map_or_else(withdrawn, |open| open.end.unwrap_or_else(|| timed_out(&open.question)))
    }
}

fn timed_out(question: &Question) -> QuestionEnd {
    let closed = Closed { how: Closing::TimedOut, answer: question.default.clone() };
    QuestionEnd { closed, author: String::new() }
}

fn withdrawn() -> QuestionEnd {
    QuestionEnd { closed: Closed { how: Closing::Withdrawn, answer: None }, author: String::new() }
}
