//! Addresses from text.

use std::str::FromStr;

use super::{Address, BAUD, Form, LslQuery, Pace, Place};
use crate::source::fault::SourceFault;
use crate::words::instead;

/// What an address may begin with.
const KINDS: [&str; 6] = ["serial", "tcp", "tcp-listen", "udp", "lsl", "phantom"];

impl FromStr for Address {
    type Err = SourceFault;

    fn from_str(text: &str) -> Result<Self, SourceFault> {
        address(text).map_err(|what| SourceFault::Address { text: text.to_owned(), what })
    }
}

fn address(text: &str) -> Result<Address, String> {
    let (head, query) = text.split_once('?').map_or((text, ""), |(head, query)| (head, query));
    let mut keys = Keys::of(query)?;
    let form = keys.form()?;
    let volts_per_count = keys.number("volts-per-count")?;
    let place = match head.split_once(':') {
        _ if head == "-" => Place::Stdin,
        Some(("serial", port)) => serial(port, &mut keys)?,
        Some(("tcp", to)) => Place::Tcp { to: host_and_port(to)?, once: keys.flag("once")? },
        Some(("tcp-listen", at)) => Place::TcpListen { at: listening(at)?, once: keys.flag("once")? },
        Some(("udp", at)) => Place::Udp { at: listening(at)? },
        Some(("lsl", which)) => Place::Lsl(lsl(which)?),
        Some(("phantom", kind)) => phantom(kind, &mut keys)?,
        Some((kind, _)) if is_word(kind) => {
            let instead = instead(kind, &KINDS);
            return Err(format!("there is no source `{kind}:`; {instead} (a file of that name is `./{head}`)"));
        }
        _ if head.is_empty() => return Err("it names nothing; write a file, `-`, or such as `serial:auto`".to_owned()),
        _ => Place::File { path: head.into(), pace: keys.pace(Pace::Max)?, looped: keys.flag("loop")? },
    };
    keys.none_left(&place)?;
    Ok(Address { place, form, volts_per_count })
}

fn is_word(kind: &str) -> bool {
    kind.len() > 1 && kind.chars().all(|c| c.is_ascii_alphanumeric() || c == '-' || c == '_')
}

fn serial(port: &str, keys: &mut Keys) -> Result<Place, String> {
    if port.is_empty() {
        return Err("it names no port; write `serial:auto` or such as `serial:/dev/ttyACM0`".to_owned());
    }
    let baud =
        match keys.take("baud") {
            None => BAUD,
            Some(text) => text.parse().ok().filter(|baud| (50..=12_000_000).contains(baud)).ok_or_else(|| {
                format!("`baud={text}` is no number of bits in a second; write such as `baud=115200`")
            })?,
        };
    Ok(Place::Serial { path: (port != "auto").then(|| port.into()), baud })
}

fn port_of(text: &str) -> Result<u16, String> {
    text.parse().map_err(|_| format!("`{text}` is no port; a port is a number up to 65535"))
}

fn host_and_port(to: &str) -> Result<String, String> {
    match to.rsplit_once(':') {
        Some((host, port)) if !host.is_empty() => port_of(port).map(|_| to.to_owned()),
        _ => Err(format!("`{to}` is no HOST:PORT; write such as `tcp:192.168.1.20:9000`")),
    }
}

/// A port alone is one of this machine.
fn listening(at: &str) -> Result<String, String> {
    if at.contains(':') { host_and_port(at) } else { port_of(at).map(|port| format!("127.0.0.1:{port}")) }
}

fn lsl(which: &str) -> Result<LslQuery, String> {
    let mut query = LslQuery::default();
    for part in which.split('&').filter(|part| !part.is_empty()) {
        let (key, value) = part.split_once('=').unwrap_or((part, ""));
        let place = match key {
            "name" => &mut query.name,
            "type" => &mut query.kind,
            "source_id" => &mut query.source_id,
            _ => return Err(format!("`{key}`: {}", instead(key, &["name", "type", "source_id"]))),
        };
        if value.is_empty() || place.replace(value.to_owned()).is_some() {
            return Err(format!("write `{key}=` once, with what the stream is found by"));
        }
    }
    if query == LslQuery::default() {
        return Err("it names no stream; write such as `lsl:name=nail` or `lsl:type=EEG`".to_owned());
    }
    Ok(query)
}

fn phantom(kind: &str, keys: &mut Keys) -> Result<Place, String> {
    if kind.is_empty() {
        return Err("it names no kind of phantom; write such as `phantom:touch?seed=1`".to_owned());
    }
    let pace = keys.pace(Pace::Rate(1.0))?;
    Ok(Place::Phantom { kind: kind.to_owned(), settings: std::mem::take(&mut keys.left), pace })
}

/// What follows the `?`.
struct Keys {
    left: Vec<(String, String)>,
}

impl Keys {
    fn of(query: &str) -> Result<Self, String> {
        let mut left: Vec<(String, String)> = Vec::new();
        for part in query.split('&').filter(|part| !part.is_empty()) {
            let (key, value) = part.split_once('=').unwrap_or((part, ""));
            if left.iter().any(|(other, _)| other == key) {
                return Err(format!("`{key}` is there twice; leave one out"));
            }
            left.push((key.to_owned(), value.to_owned()));
        }
        Ok(Self { left })
    }

    fn take(&mut self, key: &str) -> Option<String> {
        let at = self.left.iter().position(|(other, _)| other == key)?;
        Some(self.left.remove(at).1)
    }

    fn flag(&mut self, key: &str) -> Result<bool, String> {
        match self.take(key).as_deref() {
            None => Ok(false),
            Some("") => Ok(true),
            Some(value) => Err(format!("`{key}` takes no value; write `{key}` without `={value}`")),
        }
    }

    fn number(&mut self, key: &str) -> Result<Option<f64>, String> {
        let Some(text) = self.take(key) else { return Ok(None) };
        let number = text.parse().ok().filter(|number: &f64| number.is_finite() && *number > 0.0);
        number.map(Some).ok_or_else(|| format!("`{key}={text}`: write a number above zero"))
    }

    fn pace(&mut self, default: Pace) -> Result<Pace, String> {
        match self.left.iter().find(|(key, _)| key == "rate").map(|(_, value)| value.as_str()) {
            Some("max") => {
                self.take("rate");
                Ok(Pace::Max)
            }
            Some(text) if text.parse::<f64>().is_err() => {
                Err(format!("`rate={text}`: write `max` or a number such as 1"))
            }
            _ => Ok(self.number("rate")?.map_or(default, Pace::Rate)),
        }
    }

    fn form(&mut self) -> Result<Form, String> {
        match self.take("form").as_deref() {
            None | Some("lines") => Ok(Form::Lines),
            Some("frames") => Ok(Form::Frames),
            Some(other) => Err(format!("`form={other}`: {}", instead(other, &["lines", "frames"]))),
        }
    }

    fn none_left(&self, place: &Place) -> Result<(), String> {
        let Some((key, _)) = self.left.first() else { return Ok(()) };
        let own: &[&str] = match place {
            Place::Serial { .. } => &["baud"],
            Place::Tcp { .. } | Place::TcpListen { .. } => &["once"],
            Place::File { .. } => &["rate", "loop"],
            _ => &[],
        };
        let known = [own, &["form", "volts-per-count"]].concat();
        Err(format!("there is no `{key}` here; {}", instead(key, &known)))
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    proptest! {
        #[test]
        fn what_is_read_is_written_so_that_it_is_read_again(
            text in "(serial|tcp|udp|lsl|phantom|a|-)[:?&=a-z0-9./ -]{0,24}",
        ) {
            if let Ok(address) = text.parse::<Address>() {
                prop_assert_eq!(address.to_string().parse::<Address>().ok(), Some(address));
            }
        }
    }

    #[test]
    fn addresses_are_read_and_written_alike() {
        for text in [
            "serial:auto",
            "serial:/dev/serial/by-id/usb-x?baud=921600",
            "serial:/dev/ttyACM0?form=frames&volts-per-count=0.0049",
            "tcp:nail.local:9000",
            "tcp:[::1]:9000?once",
            "tcp-listen:0.0.0.0:9000?once",
            "udp:127.0.0.1:9000",
            "lsl:name=nail&type=EEG&source_id=a b",
            "-",
            "-?form=frames",
            "runs/log.csv",
            "runs/log.csv?rate=2.5&loop",
            "phantom:touch?seed=1&minutes=3",
            "phantom:touch?rate=max",
        ] {
            let address: Address = text.parse().unwrap();
            assert_eq!(address.to_string(), text);
        }
        for (text, same) in [
            ("udp:9000", "udp:127.0.0.1:9000"),
            ("tcp-listen:9000", "tcp-listen:127.0.0.1:9000"),
            ("log.csv?rate=max&form=lines", "log.csv"),
            ("serial:auto?baud=115200", "serial:auto"),
            ("phantom:touch?rate=1", "phantom:touch"),
        ] {
            assert_eq!(text.parse::<Address>().unwrap().to_string(), same);
        }
        // A drive, and a name with a colon.
        assert!(matches!(r"C:\log.csv".parse::<Address>().unwrap().place, Place::File { .. }));
        assert!(matches!("./a:b.csv".parse::<Address>().unwrap().place, Place::File { .. }));
    }

    #[test]
    fn what_is_wrong_is_named_with_what_to_write() {
        for (text, words) in [
            ("", "names nothing"),
            ("seral:auto", "did you mean `serial`?"),
            ("bluetooth:x", "known: serial, tcp"),
            ("serial:", "serial:auto"),
            ("serial:auto?bauds=9600", "did you mean `baud`?"),
            ("serial:auto?baud=fast", "baud=115200"),
            ("serial:auto?baud=9600&baud=9600", "twice"),
            ("tcp:9000", "HOST:PORT"),
            ("tcp:host:99999", "65535"),
            ("udp:x", "`x` is no port"),
            ("lsl:", "lsl:name=nail"),
            ("lsl:nme=x", "did you mean `name`?"),
            ("log.csv?rat=1", "did you mean `rate`?"),
            ("log.csv?rate=-1", "above zero"),
            ("log.csv?rate=fast", "`max` or a number"),
            ("log.csv?loop=3", "without `=3`"),
            ("log.csv?baud=9600", "known: rate, loop"),
            ("-?form=frame", "did you mean `frames`?"),
            ("-?volts-per-count=0", "above zero"),
            ("phantom:", "phantom:touch"),
        ] {
            let said = text.parse::<Address>().unwrap_err().to_string();
            assert!(said.contains(words), "{text}: {said}");
        }
    }
}
