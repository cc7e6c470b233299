#pragma once

#include "app/report/sheet/sheet_run.h"

namespace app {

/// As make_sheet(), with the dates of the program's file and of now.
core::Result<MadeSheet> make_dated_sheet(const CheckJob& job, SheetWishes wishes);

} // namespace app
