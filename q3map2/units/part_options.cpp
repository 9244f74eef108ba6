// GPL-2.0-or-later. -part, -partfile and -join: one map computed by several machines, in parts.
#include "q3map2/units/part_options.h"

#include "common/error.h"
#include "common/text/text.h"
#include "q3map2/units/unit_file.h"

#include <algorithm>
#include <filesystem>
#include <map>

namespace q3 {

// ---- Options ----

namespace {

constexpr int kMaxParts = 10000;

PartNumber ParsePart(const std::string &text) {
    const std::size_t slash = text.find('/');
    const auto number = [&](std::size_t from, std::size_t count) {
        const std::string digits = text.substr(from, count);
        const bool isNumber = !digits.empty() && digits.size() <= 5 &&
                              std::ranges::all_of(digits, [](char c) { return c >= '0' && c <= '9'; });
        return isNumber ? std::stoi(digits) : 0;
    };
    const PartNumber part{slash == text.npos ? 0 : number(0, slash),
                          slash == text.npos ? 0 : number(slash + 1, text.npos)};
    if (part.number < 1 || part.count < part.number || part.count > kMaxParts)
        throw Error("-part {}: expected I/N, part I of N, such as 2/4, with at most {} parts", text, kMaxParts);
    return part;
}

/// Replaces -join A B C by -join A -join B -join C. The last word of the line is the map.
void SpreadJoin(Arguments &arguments) {
    std::vector<std::string> files;
    for (std::size_t i = 0; i < arguments.Rest().size(); ++i) {
        if (!EqualNoCase(arguments.Rest()[i], "-join"))
            continue;
        arguments.TakeAt(i);
        const std::size_t before = files.size();
        while (i + 1 < arguments.Rest().size() && !arguments.Rest()[i].starts_with('-'))
            files.push_back(arguments.TakeAt(i));
        if (files.size() == before)
            throw Error("-join: expected the files of the parts, and after them another option or the map");
        --i;
    }
    std::vector<std::string> words;
    for (std::string &file : files)
        words.push_back("-join"), words.push_back(std::move(file));
    arguments.Prepend(words);
}

} // namespace

std::vector<SettingGroup<PartOptions>> PartSettings() {
    return {{"Parts on several machines",
             "The page [Many machines](../guide/many_machines.md) shows how to use these options. The result has the "
             "same bytes for any number of parts. The worldspawn key `_q3map2_cmdline` does not record them.",
             {{{.name = "-part",
                .values = "I/N",
                .kind = SettingKind::Text,
                .help = "Computes only part I of N, and writes its results to the file of -partfile",
                .details = "The map stays as it is. All parts must get the same options and the same files.",
                .since = "0.2.0",
                .example = "2/4"},
               Do<PartOptions>(
                   [](PartOptions &o, const SettingValues &values) { o.part = ParsePart(values.words.front()); })},
              {{.name = "-partfile",
                .values = "FILE",
                .help = "The file for the results of -part, or of a -join after which another round follows",
                .since = "0.2.0",
                .example = "part2.q3p"},
               &PartOptions::file},
              {{.name = "-join",
                .values = "FILE...",
                .kind = SettingKind::Text,
                .help = "Takes the results of all parts from files instead of computing them",
                .details = "The files follow up to the next option or to the map. If there is another round of parts "
                           "and `-partfile` is given, the joined results are written to that file. Otherwise the "
                           "run computes what is left and writes the map. A part that is missing, there twice or of "
                           "other inputs is an error.",
                .since = "0.2.0",
                .example = "part1.q3p"},
               &PartOptions::join}}}};
}

PartOptions TakePartOptions(Arguments &arguments, Log &log) {
    SpreadJoin(arguments);
    PartOptions options;
    TakeSettings(PartSettings(), options, arguments, log);
    if (options.part && options.file.empty())
        throw Error("-part: expected -partfile FILE too, for the results of the part");
    if (!options.file.empty() && !options.part && options.join.empty())
        throw Error("-partfile: expected -part I/N or -join FILES too");
    return options;
}

// ---- Files of parts ----

namespace {

/// Files of the parts of one round, by number of the part.
using Round = std::map<int, std::string>;

void AddPart(const UnitFileHeader &header, const std::string &file, int count, Round &round) {
    if (header.part.count != count)
        throw Error("{}: part {} of {}, but another file is of {} parts", file, header.part.number, header.part.count,
                    count);
    const auto [known, isNew] = round.emplace(header.part.number, file);
    if (!isNew)
        throw Error("{}: part {} of {}, which is there twice: also in {}", file, header.part.number, count,
                    known->second);
}

void RequireComplete(int round, int count, const Round &files) {
    for (int number = 1; number <= count; ++number)
        if (!files.contains(number))
            throw Error("-join: part {} of {} of round {} is missing", number, count, round);
}

} // namespace

std::unique_ptr<UnitStore> MakePartStore(const PartOptions &options, std::string_view stage, Log &log) {
    if (!options.Any())
        return nullptr;
    auto units = std::make_unique<UnitStore>(UnitStore::Purpose::Parts, options.part);
    std::map<int, Round> rounds;
    std::map<int, int> counts; // of parts, by round
    Hash128 inputs;
    for (const std::string &file : options.join) {
        UnitFile read = ReadUnitFile(file);
        const UnitFileHeader &header = read.header;
        if (header.stage != stage)
            throw Error("{}: results of {}, expected those of {}", file, header.stage, stage);
        if (&file == &options.join.front())
            inputs = header.inputs;
        constexpr int kMaxRounds = 1000;
        if (header.part.number < 1 || header.part.count < header.part.number || header.part.count > kMaxParts ||
            header.round < 1 || header.round > kMaxRounds)
            throw Error("{}: part {} of {} of round {}, which cannot be", file, header.part.number, header.part.count,
                        header.round);
        if (header.inputs != inputs)
            throw Error("{}: of another map, other options, other game files or another version than {}", file,
                        options.join.front());
        AddPart(header, file, counts.emplace(header.round, header.part.count).first->second, rounds[header.round]);
        log.Verbose("{}: {}\n", file, header.text);
        units->Load(read.results, std::move(read.storage), inputs);
    }
    for (const auto &[round, files] : rounds) {
        RequireComplete(round, counts[round], files);
        units->roundsBefore = std::max(units->roundsBefore, round);
    }
    // A complete round of one file may be a join, which holds the rounds before it too.
    const int first = rounds.empty() ? 1 : rounds.begin()->first;
    for (int round = first > 1 && counts[first] > 1 ? 1 : first; round <= units->roundsBefore; ++round)
        if (!rounds.contains(round))
            throw Error("-join: the results of round {} are missing: give the file that joined them too", round);
    return units;
}

bool EndsWithFile(const PartOptions &options, const UnitStore &units, int rounds) {
    return options.part || (!options.file.empty() && units.roundsBefore < rounds);
}

void WritePartFile(const PartOptions &options, const UnitStore &units, std::string_view stage, std::string_view map,
                   Log &log) {
    const PartNumber part = options.part.value_or(PartNumber{});
    const int round = units.roundsBefore + (options.part ? 1 : 0);
    UnitFile file;
    file.header = {.stage = std::string(stage),
                   .text = options.part
                               ? fmt::format("part {} of {}, round {}, of {}", part.number, part.count, round, map)
                               : fmt::format("joined results of round {} of {}", round, map),
                   .inputs = units.Inputs(),
                   .round = round,
                   .part = part};
    file.results = options.part ? units.Kept() : units.Used();
    log.Print("Writing {}\n", options.file);
    WriteUnitFile(options.file, file);
    log.Count(file.results.size(), "results of units");
    if (options.part)
        log.Print("{} stays as it is: a run with -join writes it\n", map);
    else
        log.Print("{} stays as it is: another round of parts follows, with -join {}\n", map, options.file);
}

} // namespace q3
