#pragma once
#include <atomic>

namespace strata {

/// From now on SIGINT and SIGTERM set the flag of stopAsked(). A second signal ends the program at once.
void listenForStop();
/// True once the user has asked the program to stop. Any thread may read it.
const std::atomic<bool>& stopAsked();

}  // namespace strata
