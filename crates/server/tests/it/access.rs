//! Who is let in, and what they may do there.

use crate::harness::House;
use rafcon_protocol::api::Role;

#[test]
fn tokens_let_in_and_nothing_else_does() {
    let house = House::new();
    let said = |token| house.ask(token, "GET", "/api/v1/projects", None).said();
    assert_eq!(said(None), "401 not_logged_in");
    assert_eq!(said(Some("wrong")), "401 not_known");
    assert_eq!(said(Some(house.token(Role::Viewer))), "200");
    assert_eq!(said(Some(house.owner())), "200");
    assert_eq!(house.call(None, "GET", "/api/v1/health", None).said(), "200");
}
