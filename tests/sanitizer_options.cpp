// Options that the sanitizers' run time asks the program for.

/// The leak check ends with signal 11 where a module was loaded at run time, as Trilinos is: it
/// takes thread-local storage for that of an older glibc (google/sanitizers, issue 1322).
extern "C" const char* __asan_default_options() { return "intercept_tls_get_addr=0"; }
