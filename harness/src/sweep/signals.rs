//! SIGINT and SIGTERM: the first lets all workers save a checkpoint and stop, the second ends everything at
//! once.

use std::collections::BTreeSet;
use std::process::Child;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex};

use rustix::process::{Pid, Signal, kill_process};
use signal_hook::consts::{SIGINT, SIGTERM};
use signal_hook::iterator::Signals;

/// Exit code after a second signal, as shells give it for SIGINT.
const INTERRUPTED: i32 = 130;

/// Passes signals on to the workers that are registered with it.
#[derive(Clone)]
pub struct Stopper {
    stopping: Arc<AtomicBool>,
    workers: Arc<Mutex<BTreeSet<i32>>>,
}

impl Stopper {
    /// Begins to listen. `on_stop` is called at the first signal.
    ///
    /// # Errors
    /// If the system does not let this process handle signals.
    pub fn listen(on_stop: impl Fn() + Send + 'static) -> std::io::Result<Self> {
        let stopper = Self { stopping: Arc::default(), workers: Arc::default() };
        let mut signals = Signals::new([SIGINT, SIGTERM])?;
        let listening = stopper.clone();
        std::thread::spawn(move || {
            for _ in signals.forever() {
                if listening.stopping.swap(true, Ordering::SeqCst) {
                    listening.tell_workers(Signal::KILL);
                    signal_hook::low_level::exit(INTERRUPTED);
                }
                on_stop();
                listening.tell_workers(Signal::TERM);
            }
        });
        Ok(stopper)
    }

    /// Whether a signal came.
    pub fn is_stopping(&self) -> bool {
        self.stopping.load(Ordering::SeqCst)
    }

    /// Signals go to `child` until the returned guard is dropped. Drop it before or soon after waiting for
    /// the child: later its process id may belong to somebody else.
    pub fn register(&self, child: &Child) -> Registered<'_> {
        let id = i32::try_from(child.id()).expect("process ids fit");
        self.workers.lock().expect("no holder of this lock panics").insert(id);
        if self.is_stopping() {
            // The signal came between the start of the worker and this line.
            tell(id, Signal::TERM);
        }
        Registered { stopper: self, id }
    }

    fn tell_workers(&self, signal: Signal) {
        for id in self.workers.lock().expect("no holder of this lock panics").iter() {
            tell(*id, signal);
        }
    }
}

/// Signals a worker. One that is already gone needs no signal.
fn tell(id: i32, signal: Signal) {
    if let Some(pid) = Pid::from_raw(id) {
        let _ = kill_process(pid, signal);
    }
}

/// See [`Stopper::register`].
pub struct Registered<'a> {
    stopper: &'a Stopper,
    id: i32,
}

impl Drop for Registered<'_> {
    fn drop(&mut self) {
        self.stopper.workers.lock().expect("no holder of this lock panics").remove(&self.id);
    }
}
