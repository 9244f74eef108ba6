// GPL-2.0-or-later. Whether bot files still fit a map after it was written.
#include "q3map2/bot_check.h"

#include "common/error.h"

namespace q3 {

BotCheck::BotCheck(std::filesystem::path bspPath, Log &log) : bspPath_(std::move(bspPath)), log_(log) {
    try {
        files_ = FindBotFiles(bspPath_);
        if (!files_.empty() && std::filesystem::exists(bspPath_))
            before_ = MapChecksum(bspPath_);
    } catch (const Error &error) {
        log_.Warn("bot file", "{}", error.what());
    }
}

void BotCheck::Fix(const BotFile &file, std::uint32_t checksum) const {
    SetChecksum(file, checksum);
    log_.Print("{} fits the map again\n", file.path.string());
    if (file.checksum != before_)
        log_.Warn("bot file",
                  "{} did not fit the map before either: if brushes have changed since it was made, bots walk into "
                  "walls; then make it again with a bot compiler",
                  file.path.string());
}

void BotCheck::Report(Change change, bool fix) const {
    if (files_.empty())
        return;
    const std::uint32_t checksum = MapChecksum(bspPath_);
    for (const BotFile &file : files_) {
        if (file.checksum == checksum)
            continue;
        if (fix && change == SameGeometry) {
            Fix(file, checksum);
            continue;
        }
        const std::string advice =
            change == OtherGeometry
                ? fmt::format("make it again with a bot compiler or, if no brush has changed, run q3map2 -fixaas {}",
                              bspPath_.string())
                : fmt::format("q3map2 -fixaas {} makes it fit again", bspPath_.string());
        const std::string text =
            fmt::format("{} is for another version of the map, and engines refuse it, so there will be no bots: {}",
                        file.path.string(), advice);
        log_.Warn("bot file", "{}", text);
    }
}

void WarnOfPackedBotFile(const std::filesystem::path &bspPath, std::span<const std::byte> botFile,
                         const std::string &origin, Log &log) {
    try {
        if (ChecksumIn(botFile, origin) != MapChecksum(bspPath))
            log.Warn("bot file",
                     "{} is for another version of {}, and engines refuse it, so there will be no bots: copy it beside "
                     "the map and run q3map2 -fixaas on the map or, if brushes have changed, make it again with a bot "
                     "compiler",
                     origin, bspPath.string());
    } catch (const Error &error) {
        log.Warn("bot file", "{}", error.what());
    }
}

} // namespace q3
