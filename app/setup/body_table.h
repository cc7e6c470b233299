#pragma once

#include <filesystem>

#include "app/setup/frames.h"
#include "app/setup/setup_file.h"
#include "app/setup/table_reader.h"

namespace app {

/// What the readers of bodies share.
struct BodyContext {
    std::filesystem::path folder; // that relative mesh paths start from
    Frames frames;
    SetupFile& file;
};

/// Reads `[stock]`: the stock's frame becomes the frame of everything else.
void read_stock(TableReader& table, BodyContext& context);

/// A stock that is inferred from the program, in the frame of G54.
void infer_stock(BodyContext& context);

/// Reads one `[[fixture]]`. The stock must have been read.
void read_fixture(TableReader& table, BodyContext& context);

} // namespace app
