//! What goes on beside HTTP, if it is wanted: a broker and records.

use std::sync::{Arc, Mutex};

use deltarobot_cli::status::Failure;
use tokio::task::JoinHandle;

use crate::fleet::Fleet;
use crate::locked;
use crate::mqtt::{self, Mqtt};
use crate::record::{self, Progress, Records};

/// Both of them.
pub(crate) struct Outside {
    /// The broker.
    pub(crate) mqtt: Option<Arc<Mqtt>>,
    /// How recording goes.
    pub(crate) progress: Option<Arc<Progress>>,
    connection: Mutex<Option<JoinHandle<()>>>,
    records: Mutex<Option<Records>>,
}

impl Outside {
    /// Begins with what is wanted, in a runtime.
    pub(crate) fn start(
        mqtt: Option<&mqtt::Settings>,
        record: Option<&record::Settings>,
        fleet: &Arc<Fleet>,
    ) -> Result<Arc<Self>, Failure> {
        let records = record.map(|settings| Records::start(settings, fleet)).transpose()?;
        let connected = mqtt.map(|settings| Mqtt::start(settings, Arc::clone(fleet))).transpose()?;
        let (mqtt, connection) = connected.unzip();
        let progress = records.as_ref().map(|records| Arc::clone(&records.progress));
        Ok(Arc::new(Self { mqtt, progress, connection: connection.into(), records: records.into() }))
    }

    /// Says goodbye to the broker, and closes the record.
    pub(crate) async fn end(&self) {
        let connection = locked(&self.connection).take();
        if let (Some(mqtt), Some(connection)) = (&self.mqtt, connection) {
            mqtt.end(connection).await;
        }
        let records = locked(&self.records).take();
        records.into_iter().for_each(Records::end);
    }
}
