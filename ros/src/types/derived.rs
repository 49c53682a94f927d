//! Messages derived from a service or an action: those that the middleware transfers, and those that only hashes use.

use super::{Base, Field, Message, Primitive, Shape};

fn field(name: &str, base: Base, shape: Shape) -> Field {
    Field { name: name.to_owned(), base, shape, text_max: 0, default: None }
}

fn message(name: String, fields: Vec<Field>) -> Message {
    Message { name, fields, constants: Vec::new() }
}

fn of(full: &str) -> Base {
    Base::Message(full.into())
}

fn goal_id() -> Field {
    field("goal_id", of("unique_identifier_msgs/msg/UUID"), Shape::One)
}

/// Messages derived from a service with a request and a response.
pub(super) fn of_service(service: &str) -> Vec<Message> {
    let part = |ending: &str| of(&format!("{service}_{ending}"));
    let event = vec![
        field("info", of("service_msgs/msg/ServiceEventInfo"), Shape::One),
        field("request", part("Request"), Shape::Bounded(1)),
        field("response", part("Response"), Shape::Bounded(1)),
    ];
    let whole = vec![
        field("request_message", part("Request"), Shape::One),
        field("response_message", part("Response"), Shape::One),
        field("event_message", part("Event"), Shape::One),
    ];
    vec![message(format!("{service}_Event"), event), message(service.to_owned(), whole)]
}

/// Messages derived from an action with a goal, a result and feedback.
pub(super) fn of_action(action: &str) -> Vec<Message> {
    let name = |ending: &str| format!("{action}_{ending}");
    let part = |ending: &str| of(&name(ending));
    let send = vec![goal_id(), field("goal", part("Goal"), Shape::One)];
    let accepted = field("accepted", Base::Primitive(Primitive::Bool), Shape::One);
    let sent = vec![accepted, field("stamp", of("builtin_interfaces/msg/Time"), Shape::One)];
    let status = field("status", Base::Primitive(Primitive::Int8), Shape::One);
    let got = vec![status, field("result", part("Result"), Shape::One)];
    let feedback = vec![goal_id(), field("feedback", part("Feedback"), Shape::One)];
    let one = |label, ending| field(label, part(ending), Shape::One);
    let whole = vec![
        one("goal", "Goal"),
        one("result", "Result"),
        one("feedback", "Feedback"),
        one("send_goal_service", "SendGoal"),
        one("get_result_service", "GetResult"),
        one("feedback_message", "FeedbackMessage"),
    ];
    let mut all = vec![
        message(name("SendGoal_Request"), send),
        message(name("SendGoal_Response"), sent),
        message(name("GetResult_Request"), vec![goal_id()]),
        message(name("GetResult_Response"), got),
        message(name("FeedbackMessage"), feedback),
        message(action.to_owned(), whole),
    ];
    all.extend(of_service(&name("SendGoal")));
    all.extend(of_service(&name("GetResult")));
    all
}
