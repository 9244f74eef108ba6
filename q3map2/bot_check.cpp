// GPL-2.0-or-later. Whether bots still know a map that is written anew.
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
                  "walls; then make it anew",
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
                ? "make it anew with a bot compiler, or, if no brush has changed, let q3map2 -fixaas enter the new map"
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
                     "the map and let q3map2 -fixaas enter the map, or, if brushes have changed, make it anew with a "
                     "bot compiler",
                     origin, bspPath.string());
    } catch (const Error &error) {
        log.Warn("bot file", "{}", error.what());
    }
}

} // namespace q3
