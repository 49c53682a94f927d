//! The changes to the published `RustDDS`.
//!
//! Peers of Fast DDS notice closed readers and writers, discover each other at once, and exchange large messages, requests
//! and responses quickly. A run receives its own messages. A new reader receives no old messages. A process continues after
//! a stop signal, and delivers its last message when it ends.

/// A change: the file, the old text, and the new text.
pub(super) type Change = (&'static str, &'static str, &'static str);

/// File with the cache of samples that readers have not passed on yet.
const CACHE: &str = "src/structure/dds_cache.rs";

pub(super) const CHANGES: &[Change] = &[
    // Fast DDS reads the key of a disposed instance only from the inline QoS (else it reports "too large key-only data"),
    // as the specification requires. A built-in key is a parameter of 16 bytes before the sentinel of 4.
    (
        "src/rtps/message.rs",
        "DDSData::DisposeByKey { .. } => {\n        param_list.push(Parameter::create_pid_status_info_parameter(",
        "DDSData::DisposeByKey { ref key, .. } => {
        if let Some(guid) = key.value.len().checked_sub(20).and_then(|at| key.value.get(at..at + 16)) {
          param_list.push(Parameter { parameter_id: ParameterId::PID_KEY_HASH, value: guid.to_vec() });
        }
        param_list.push(Parameter::create_pid_status_info_parameter(",
    ),
    // Without this change a participant does not find itself if the loopback interface is the only one.
    (
        "src/rtps/message_receiver.rs",
        "if source_prefix == GuidPrefix::UNKNOWN || source_prefix == self.own_guid_prefix {\n      return;",
        "if source_prefix == GuidPrefix::UNKNOWN {\n      return;",
    ),
    // Fast DDS (vendor 1.15) responds to a reader's first request only if it has the number 0, as from its own readers.
    // Otherwise earlier messages arrive seconds later.
    (
        "src/rtps/reader.rs",
        "reader_sn_state: SequenceNumberSet::new_empty(SequenceNumber::new(1)),\n        count: acknack_count,",
        "reader_sn_state: SequenceNumberSet::new_empty(SequenceNumber::new(
          i64::from(!remote_writer_guid.prefix.as_ref().starts_with(&[1, 15])),
        )),
        count: acknack_count,",
    ),
    // Parts of 256 bytes overflow the sockets of peers at once, and then arrive at only 0.8 MB/s.
    (
        "src/rtps/constant.rs",
        "pub const FRAGMENT_SIZE: usize = 256;",
        "pub const FRAGMENT_SIZE: usize = 32_000;",
    ),
    (
        "src/rtps/constant.rs",
        "pub const REPAIR_BATCH_MAX_BYTES: usize = 8192;",
        "pub const REPAIR_BATCH_MAX_BYTES: usize = 1 << 17;",
    ),
    // A stopped and continued process is interrupted in its wait. Without these two changes it receives nothing afterwards.
    (
        "src/rtps/dp_event_loop.rs",
        "        Ok(_) => {}\n        Err(e) => {\n          error!(\"dp_event_loop poll failed",
        "        Ok(_) => {}
        Err(e) if e.kind() == std::io::ErrorKind::Interrupted => {}
        Err(e) => {\n          error!(\"dp_event_loop poll failed",
    ),
    (
        "src/discovery/discovery.rs",
        "        Ok(_) => (),\n        Err(e) => {\n          error!(\"Failed in waiting of poll in discovery",
        "        Ok(_) => (),
        Err(e) if e.kind() == std::io::ErrorKind::Interrupted => (),
        Err(e) => {\n          error!(\"Failed in waiting of poll in discovery",
    ),
    // Samples that a writer had confirmed before its end stay readable while they are cached. Otherwise the last response
    // of a server that ends is lost if nobody has read it by then.
    (
        CACHE,
        "  received_reliably_before: BTreeMap<GUID, SequenceNumber>,\n}",
        "  received_reliably_before: BTreeMap<GUID, SequenceNumber>,\n  gone: BTreeMap<GUID, SequenceNumber>,\n}",
    ),
    (
        CACHE,
        "      received_reliably_before: BTreeMap::new(),\n",
        "      received_reliably_before: BTreeMap::new(),\n      gone: BTreeMap::new(),\n",
    ),
    (
        CACHE,
        "    self.received_reliably_before.remove(&writer);\n",
        "    if let Some(marker) = self.received_reliably_before.remove(&writer) {
      if self.sequence_numbers.contains_key(&writer) {
        self.gone.insert(writer, marker);
      }
    }\n",
    ),
    (
        CACHE,
        "      .get(&writer)\n      .cloned()\n      .unwrap_or(SequenceNumber::default())",
        "      .get(&writer)\n      .or_else(|| self.gone.get(&writer))\n      .cloned()\n      .unwrap_or(SequenceNumber::default())",
    ),
    (
        CACHE,
        "      self.sequence_numbers.remove(&cc.writer_guid);\n",
        "      self.sequence_numbers.remove(&cc.writer_guid);\n      self.gone.remove(&cc.writer_guid);\n",
    ),
    // The length of inline QoS lacks the byte that marks an optional value, so peers drop fragments of requests and
    // responses.
    (
        "src/messages/submessages/data_frag.rs",
        "    if self.inline_qos.is_some() && !self.inline_qos.as_ref().unwrap().parameters.is_empty() {
      writer.write_value(&self.inline_qos)?;
    }",
        "    if let Some(inline_qos) = &self.inline_qos {
      writer.write_value(inline_qos)?;
    }",
    ),
    // Each reader has its own cache. In a cache shared by all readers of a topic, a new reader finds old messages.
    (
        "src/dds/pubsub.rs",
        "    let topic_cache_handle = match dp.dds_cache().read() {
      Ok(dds_cache) => dds_cache.get_existing_topic_cache(&topic.name())?,",
        "    let topic_cache_handle = match dp.dds_cache().write() {
      Ok(mut dds_cache) => dds_cache.cache_of_reader(topic.name(), topic.get_type(), &qos),",
    ),
    (
        CACHE,
        "  topic_caches: HashMap<String, Arc<Mutex<TopicCache>>>,
}",
        "  topic_caches: HashMap<String, Arc<Mutex<TopicCache>>>,
  of_readers: Vec<std::sync::Weak<Mutex<TopicCache>>>,
}",
    ),
    (
        CACHE,
        "  pub(crate) fn get_existing_topic_cache(",
        "  pub(crate) fn cache_of_reader(
    &mut self,
    topic_name: String,
    topic_data_type: TypeDesc,
    qos: &QosPolicies,
  ) -> Arc<Mutex<TopicCache>> {
    let cache = Arc::new(Mutex::new(TopicCache::new(topic_name, topic_data_type, qos)));
    self.of_readers.push(Arc::downgrade(&cache));
    cache
  }

  #[allow(dead_code)]
  pub(crate) fn get_existing_topic_cache(",
    ),
    (
        CACHE,
        "    for tc in self.topic_caches.values_mut() {
",
        "    self.of_readers.retain(|cache| cache.strong_count() > 0);
    for tc in self.of_readers.iter().filter_map(std::sync::Weak::upgrade) {
",
    ),
];
