#include "app/guard/shell.h"

namespace app {

core::Result<ShellOutput> run_in_shell(const std::string&, const std::string&) {
    return core::fail(core::ErrorCode::unsupported, "needs a shell, which Windows does not have");
}

} // namespace app
