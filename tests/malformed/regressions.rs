//! What once got through, by reader; and what is known to break readers elsewhere.

use crate::harness::run_alone;
use crate::targets::named;

/// Refused, by a message that says all of `parts`.
#[track_caller]
fn refused(reader: &str, input: &[u8], parts: &[&str]) {
    let ran = run_alone(named(reader), input);
    assert_eq!(ran.failure, None, "{reader}");
    let message = ran.read.expect_err(reader);
    for part in parts {
        assert!(message.contains(part), "{reader}: {part:?} is not in {message:?}");
    }
}
