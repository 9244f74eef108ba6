// GPL-2.0-or-later. Records command lines of the stages in worldspawn.
#include "q3map2/command_record.h"

#include "q3map2/version.h"

namespace q3 {

namespace {

/// Engines read at most 1024 bytes of a value; the oldest records go first.
constexpr std::size_t kMaxRecord = 900;

} // namespace

void RecordCommand(Entity &world, std::string_view stage, const std::vector<std::string> &words) {
    std::string command(stage);
    for (const std::string &word : words) {
        command += ' ';
        for (const char c : word)
            if (c != '\\' && c != '"' && c != ';' && static_cast<unsigned char>(c) >= 32)
                command += c;
    }
    std::string record(world.Value("_q3map2_cmdline"));
    record += (record.empty() ? "" : "; ") + command;
    while (record.size() > kMaxRecord && record.find("; ") != std::string::npos)
        record.erase(0, record.find("; ") + 2);
    world.Set("_q3map2_cmdline", record.substr(0, kMaxRecord));
    world.Set("_q3map2_version", kVersion);
}

void RecordCommand(Bsp &bsp, std::string_view stage, std::string_view name, const std::vector<std::string> &words) {
    std::vector<Entity> entities = StoredEntities(bsp.entities, name);
    RecordCommand(entities.front(), stage, words);
    bsp.entities = FormatEntities(entities);
}

} // namespace q3
