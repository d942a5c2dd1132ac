//! The layer of `tracing` through which a [`Recorder`] sees spans and GPU passes.

use std::borrow::Cow;
use std::fmt::Debug;

use tracing::field::{Field, Visit};
use tracing::span::{Attributes, Id};
use tracing::{Event, Subscriber};
use tracing_subscriber::Layer;
use tracing_subscriber::layer::Context;
use tracing_subscriber::registry::LookupSpan;

use super::{Lane, Recorder, TraceSpan};
use crate::profile::clock::clock_ns;

pub(super) struct SpanLayer(pub(super) Recorder);

/// A span that is open.
struct Open {
    name: Cow<'static, str>,
    which: Option<(&'static str, u64)>,
    begin_ns: u64,
}

impl<S: Subscriber + for<'a> LookupSpan<'a>> Layer<S> for SpanLayer {
    fn on_new_span(&self, attributes: &Attributes<'_>, id: &Id, context: Context<'_, S>) {
        let Some(span) = context.span(id).filter(|_| self.0.is_on()) else { return };
        let mut fields = Fields::default();
        attributes.record(&mut fields);
        let name = fields.name.map_or(Cow::Borrowed(attributes.metadata().name()), Cow::Owned);
        let which = fields.numbers.first().copied();
        span.extensions_mut().insert(Open { name, which, begin_ns: 0 });
    }

    fn on_enter(&self, id: &Id, context: Context<'_, S>) {
        let Some(span) = context.span(id) else { return };
        if let Some(open) = span.extensions_mut().get_mut::<Open>() {
            open.begin_ns = clock_ns();
        }
    }

    fn on_exit(&self, id: &Id, context: Context<'_, S>) {
        let end_ns = clock_ns();
        let Some(span) = context.span(id) else { return };
        let span = span.extensions().get::<Open>().map(|Open { name, which, begin_ns }| TraceSpan {
            name: name.clone(),
            lane: self.0.lane(),
            begin_ns: *begin_ns,
            end_ns,
            which: *which,
        });
        if let Some(span) = span.filter(|_| self.0.is_on()) {
            self.0.push(span);
        }
    }

    fn on_event(&self, event: &Event<'_>, _: Context<'_, S>) {
        if !self.0.is_on() {
            return;
        }
        let mut fields = Fields::default();
        event.record(&mut fields);
        let number = |name: &str| fields.numbers.iter().find(|(field, _)| *field == name).map(|(_, number)| *number);
        let (Some(name), Some(begin_ns), Some(end_ns)) = (fields.name.clone(), number("begin_ns"), number("end_ns"))
        else {
            return;
        };
        self.0.push(TraceSpan { name: Cow::Owned(name), lane: Lane::Gpu, begin_ns, end_ns, which: None });
    }
}

/// The field `name`, and all numbers.
#[derive(Default)]
struct Fields {
    name: Option<String>,
    numbers: Vec<(&'static str, u64)>,
}

impl Visit for Fields {
    fn record_u64(&mut self, field: &Field, value: u64) {
        self.numbers.push((field.name(), value));
    }

    fn record_str(&mut self, field: &Field, value: &str) {
        if field.name() == "name" {
            self.name = Some(value.to_owned());
        }
    }

    fn record_debug(&mut self, _: &Field, _: &dyn Debug) {}
}
