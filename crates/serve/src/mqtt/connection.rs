//! How the broker is reached.

use std::fs;
use std::path::Path;
use std::sync::Arc;
use std::time::Duration;

use deltarobot_cli::status::{Failure, system_text};
use rumqttc::v5::mqttbytes::QoS;
use rumqttc::v5::mqttbytes::v5::{ConnectReturnCode, LastWill};
use rumqttc::v5::{ConnectionError, MqttOptions};
use rumqttc::{TlsConfiguration, Transport};
use rustls::pki_types::pem::PemObject;
use rustls::pki_types::{CertificateDer, PrivateKeyDer};
use rustls::{ClientConfig, RootCertStore};
use serde_json::json;

use super::Settings;

/// Bytes of a message that is taken.
const MESSAGE_MAX: u32 = 16 << 10;
/// The broker is asked so often whether it is there.
const KEEP_ALIVE: Duration = Duration::from_secs(10);
/// How long connecting may take, in seconds.
const CONNECT_TIME: u64 = 10;
/// Messages that the broker may leave unacknowledged, if it does not say fewer.
const UNACKNOWLEDGED_MAX: u16 = 1000;

/// Where it says whether this program is there.
pub(super) fn status_topic(prefix: &str) -> String {
    format!("{prefix}/status")
}

/// What it says there.
pub(super) fn status(word: &str) -> String {
    json!({ "status": word, "version": env!("CARGO_PKG_VERSION") }).to_string()
}

/// What the settings say.
pub(super) fn options(settings: &Settings) -> Result<MqttOptions, Failure> {
    let wrong = |text: &str| Failure::Usage(format!("mqtt: {text}"));
    let (is_secure, address) = match settings.url.split_once("://") {
        Some(("mqtt", address)) => (false, address),
        Some(("mqtts", address)) => (true, address),
        _ => return Err(wrong("url has to be mqtt://HOST:PORT or mqtts://HOST:PORT")),
    };
    let (host, port) = address.rsplit_once(':').filter(|(host, _)| !host.is_empty()).unwrap_or((address, ""));
    let port = match port {
        "" => Ok(if is_secure { 8883 } else { 1883 }),
        port => port.parse().map_err(|_| wrong("url: that is no port")),
    }?;
    if host.is_empty() || host.contains(['@', '/']) {
        return Err(wrong("url has to be mqtt://HOST:PORT or mqtts://HOST:PORT"));
    }
    if settings.prefix.is_empty() || settings.prefix.contains(['+', '#', '\0']) || settings.prefix.starts_with('$') {
        return Err(wrong("prefix is no topic"));
    }
    let id = settings.client_id.clone().map_or_else(random_id, Ok)?;
    let mut options = MqttOptions::new(id, host.trim_matches(['[', ']']), port);
    let will = LastWill::new(status_topic(&settings.prefix), status("offline"), QoS::AtLeastOnce, true, None);
    options
        .set_clean_start(true)
        .set_keep_alive(KEEP_ALIVE)
        .set_connection_timeout(CONNECT_TIME)
        .set_max_packet_size(Some(MESSAGE_MAX))
        .set_outgoing_inflight_upper_limit(UNACKNOWLEDGED_MAX)
        .set_last_will(will);
    if let Some(user) = &settings.user {
        let password = settings.password_file.as_deref().map(read).transpose()?.unwrap_or_default();
        options.set_credentials(user, String::from_utf8_lossy(&password).trim_end_matches(['\n', '\r']));
    } else if settings.password_file.is_some() {
        return Err(wrong("password_file is for a user"));
    }
    if is_secure {
        let tls = TlsConfiguration::Rustls(Arc::new(tls(settings)?));
        options.set_transport(Transport::tls_with_config(tls));
    } else if settings.ca_file.is_some() || settings.cert_file.is_some() || settings.key_file.is_some() {
        return Err(wrong("ca_file, cert_file and key_file are for mqtts://"));
    }
    Ok(options)
}

fn read(path: &Path) -> Result<Vec<u8>, Failure> {
    fs::read(path).map_err(|error| Failure::of_file(path.display(), &error))
}

fn certificates(path: &Path) -> Result<Vec<CertificateDer<'static>>, Failure> {
    let bytes = read(path)?;
    let found: Result<Vec<_>, _> = CertificateDer::pem_slice_iter(&bytes).collect();
    match found {
        Ok(found) if !found.is_empty() => Ok(found),
        _ => Err(Failure::of(path.display(), "there are no certificates in it (PEM)")),
    }
}

fn tls(settings: &Settings) -> Result<ClientConfig, Failure> {
    let failure = |error: rustls::Error| Failure::of("mqtt", error);
    let mut roots = RootCertStore::empty();
    let trusted = match &settings.ca_file {
        Some(path) => certificates(path)?,
        None => rustls_native_certs::load_native_certs().certs,
    };
    roots.add_parsable_certificates(trusted);
    if roots.is_empty() {
        return Err(Failure::Usage("mqtt: no authority vouches for the broker; ca_file names one".into()));
    }
    let provider = Arc::new(rustls::crypto::ring::default_provider());
    let builder =
        ClientConfig::builder_with_provider(provider).with_safe_default_protocol_versions().map_err(failure)?;
    let builder = builder.with_root_certificates(roots);
    match (&settings.cert_file, &settings.key_file) {
        (Some(certificate), Some(key)) => {
            let secret = PrivateKeyDer::from_pem_slice(&read(key)?)
                .map_err(|_| Failure::of(key.display(), "there is no private key in it (PEM)"))?;
            builder.with_client_auth_cert(certificates(certificate)?, secret).map_err(failure)
        }
        (None, None) => Ok(builder.with_no_client_auth()),
        _ => Err(Failure::Usage("mqtt: cert_file and key_file belong together".into())),
    }
}

fn random_id() -> Result<String, Failure> {
    let mut bytes = [0; 8];
    getrandom::fill(&mut bytes).map_err(|error| Failure::of("mqtt", error))?;
    Ok(format!("deltarobot-{:016x}", u64::from_ne_bytes(bytes)))
}

/// Why there is no connection.
pub(super) fn text(error: &ConnectionError) -> String {
    match error {
        ConnectionError::ConnectionRefused(
            ConnectReturnCode::BadUserNamePassword | ConnectReturnCode::NotAuthorized,
        ) => "the broker refuses this user or password".into(),
        ConnectionError::ConnectionRefused(code) => format!("the broker refuses the connection: {code:?}"),
        ConnectionError::Io(error) => system_text(error),
        ConnectionError::Timeout(_) => "the broker does not answer".into(),
        error => error.to_string(),
    }
}
