//! The end of the process.

use std::io::Write;

/// Ends the process at once, and with it whatever other threads do; never returns.
///
/// Whoever leaves while shaders are compiled leaves threads behind that compile them. `std::process::exit` first runs what
/// C libraries have registered for the end of a process, on memory that those threads still use: software Vulkan then ended
/// now and then by a fault, so that a player who pressed Escape was told of a crash. The system takes all back by itself.
pub fn end(status: u8) -> ! {
    // Nobody is left to be told that printing failed.
    let _ = std::io::stdout().flush();
    let _ = std::io::stderr().flush();
    #[cfg(unix)]
    {
        #[expect(unsafe_code, reason = "the standard library has no such exit")]
        // SAFETY: `_exit` takes any number, reads no memory of the process, and does not return.
        unsafe {
            libc::_exit(status.into())
        }
    }
    #[cfg(not(unix))]
    std::process::exit(status.into())
}
