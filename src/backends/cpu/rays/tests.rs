//! Rays against the footprints of the same frames, which share no code with them but the integrals.
