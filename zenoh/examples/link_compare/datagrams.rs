//! A datagram for each change, with the whole path as text, and no answer: as the reference's monitoring plugin sends them.

use crate::Trial;
use crate::figures::{Figures, Recorder};
use crate::proxy::Carries;
use anyhow::Result;
use serde_json::{Value, json};
use std::sync::Arc;
use tokio::net::UdpSocket;

/// Sends each event once.
pub(crate) async fn carry(trial: &Trial) -> Result<Figures> {
    let (robot, station) =
        (UdpSocket::bind("127.0.0.1:0").await?, UdpSocket::bind("127.0.0.1:0").await?);
    let proxy = trial.link(Carries::Datagrams, station.local_addr()?)?;
    let (recorder, to) = (Arc::new(Recorder::new(trial.begin, &trial.events)), proxy.address);
    let notes = Arc::clone(&recorder);
    tokio::spawn(async move {
        let mut buffer = [0; 4_096];
        while let Ok(length) = station.recv(&mut buffer).await {
            let said: Option<Value> = serde_json::from_slice(&buffer[..length]).ok();
            let number = said.and_then(|said| said["sequence"].as_u64());
            notes
                .note(number.and_then(|number| usize::try_from(number).ok()).unwrap_or(usize::MAX));
        }
    });
    let sends = trial.clone();
    tokio::spawn(async move {
        for number in sends.numbers() {
            sends.happens(number).await;
            let event = &sends.events.list[number];
            let said = json!({
                "sequence": number,
                "time": event.time.as_secs_f64(),
                "path": event.path,
                "name": event.names,
                "status": "STATE_MACHINE_EXECUTION_STATUS.STARTED",
            });
            drop(robot.send_to(said.to_string().as_bytes(), to).await);
        }
    });
    trial.judge(proxy, &recorder).await
}
