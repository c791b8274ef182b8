//! `deltarobot ports`: what could be opened.

use std::path::Path;

use serde_json::json;
use serialport::SerialPortType;

use crate::screen::Screen;
use crate::status::{Failure, Status};

#[derive(Debug, clap::Args)]
pub(crate) struct Arguments {
    /// One JSON object a line
    #[arg(long)]
    json: bool,
}

pub(crate) fn run(arguments: &Arguments) -> Result<Status, Failure> {
    // (Without that directory the library would panic.)
    let has_ports = !cfg!(target_os = "linux") || Path::new("/sys/class/tty").is_dir();
    let mut ports = if has_ports {
        serialport::available_ports().map_err(|error| Failure::of("serial ports", error))?
    } else {
        Vec::new()
    };
    ports.sort_by(|one, other| one.port_name.cmp(&other.port_name));
    let mut screen = Screen::new();
    for port in ports {
        let usb = match &port.port_type {
            SerialPortType::UsbPort(usb) => Some(usb),
            _ => None,
        };
        if arguments.json {
            screen.put_json(&json!({
                "port": port.port_name,
                "manufacturer": usb.and_then(|usb| usb.manufacturer.as_ref()),
                "product": usb.and_then(|usb| usb.product.as_ref()),
                "serial_number": usb.and_then(|usb| usb.serial_number.as_ref()),
                "vendor_id": usb.map(|usb| usb.vid),
                "product_id": usb.map(|usb| usb.pid),
            }))?;
        } else {
            let mut line = port.port_name;
            if let Some(usb) = usb {
                let words = [usb.manufacturer.as_deref(), usb.product.as_deref()];
                let serial = usb.serial_number.as_ref().map(|serial| format!("serial number {serial}"));
                let ids = format!("{:04x}:{:04x}", usb.vid, usb.pid);
                for word in words.into_iter().flatten().chain([ids.as_str()]).chain(serial.as_deref()) {
                    line += "  ";
                    line += word;
                }
            }
            screen.put(&line)?;
        }
    }
    screen.flush()?;
    Ok(Status::Finished)
}
