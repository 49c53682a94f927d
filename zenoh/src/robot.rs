//! The side of a robot: sends its datagrams to stations, and forwards those of its stations to its last source address.

use crate::carry::{DATAGRAM_MAX, LastHeard, keep_session, put, receive};
use crate::command_line::{Network, RobotSide, print};
use crate::keys::{explain, is_part};
use anyhow::{Context as _, Result, anyhow, bail};
use std::net::SocketAddr;
use std::sync::{Arc, Mutex, PoisonError};
use tokio::net::UdpSocket;
use zenoh::Session;
use zenoh::qos::Priority;

/// Last source address of the robot's server.
type RobotAddress = Arc<Mutex<Option<SocketAddr>>>;

/// Carries the datagrams of one robot until this program ends.
pub(crate) async fn carry(network: &Network, side: &RobotSide) -> Result<()> {
    if !is_part(&side.robot) {
        bail!("`{}` is no robot: {}", side.robot, explain("robot"));
    }
    let socket = UdpSocket::bind(side.listen).await;
    let socket = socket.with_context(|| {
        format!("cannot receive at {}: choose another address with --listen", side.listen)
    })?;
    print(&format!("the robot sends to udp://{}", socket.local_addr()?));
    let (socket, robot) = (Arc::new(socket), RobotAddress::default());
    keep_session(network, |session, heard| {
        carry_in(network, side, session, heard, (Arc::clone(&socket), Arc::clone(&robot)))
    })
    .await
}

async fn carry_in(
    network: &Network,
    side: &RobotSide,
    session: Session,
    heard: Arc<LastHeard>,
    (socket, robot): (Arc<UdpSocket>, RobotAddress),
) -> Result<()> {
    let (down, up) = (network.fleet.down(&side.robot), network.fleet.up(&side.robot));
    let presence = session.liveliness().declare_token(network.fleet.presence(&side.robot)).await;
    let _presence = presence.map_err(|error| anyhow!(error))?;
    let (answering, to) = (Arc::clone(&socket), Arc::clone(&robot));
    let answers = session.declare_subscriber(up).callback(move |sample| {
        heard.note();
        let to = *to.lock().unwrap_or_else(PoisonError::into_inner);
        let payload = sample.payload().to_bytes();
        if let Some(to) = to.filter(|_| payload.len() <= DATAGRAM_MAX) {
            // A full socket drops the datagram, as on any link.
            drop(answering.try_send_to(&payload, to));
        }
    });
    let _answers = answers.await.map_err(|error| anyhow!(error))?;
    let mut buffer = [0; DATAGRAM_MAX + 1];
    loop {
        let (datagram, from) = receive(&socket, &mut buffer).await;
        *robot.lock().unwrap_or_else(PoisonError::into_inner) = Some(from);
        put(&session, &down, datagram, Priority::DataHigh).await;
    }
}
