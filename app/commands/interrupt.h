#pragma once

namespace app {

/// From now on Ctrl-C only sets a flag.
void catch_interrupts();

/// Whether Ctrl-C was pressed since the last call of clear_interrupt.
bool was_interrupted();
void clear_interrupt();

} // namespace app
