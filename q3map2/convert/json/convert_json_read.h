// GPL-2.0-or-later. Reads the records of a JSON file one by one. See docs/json.md.
#pragma once

#include "common/error.h"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <string_view>
#include <vector>

namespace q3 {

/// One value of a record; the children of objects and arrays follow it.
struct JsonNode {
    enum Kind : std::uint8_t { Object, Array, Integer, Real, Text, Other };
    Kind kind = Other;
    std::size_t nameAt = 0, nameLength = 0; ///< of a member, in JsonRecord::chars
    std::size_t next = 0;                   ///< index of the node after this one and its descendants
    std::size_t count = 0;                  ///< children
    std::int64_t integer = 0;
    float real = 0;       ///< of Integer, Real and special Text
    bool special = false; ///< Text that spells NaN or an infinity, in quotes or bare
    std::size_t textAt = 0, textLength = 0;
};

/// A member of the top-level object, or an element of its list. Valid during the call it is passed to.
struct JsonRecord {
    std::string file;            ///< path, for messages
    std::string name;            ///< of the top-level member
    bool inList = false;         ///< an element of the list `name`
    std::size_t index = 0;       ///< index among the records of that kind
    std::vector<JsonNode> nodes; ///< the first is the record itself
    std::string chars;           ///< names and texts

    std::string_view Name(const JsonNode &node) const {
        return std::string_view(chars).substr(node.nameAt, node.nameLength);
    }
    std::string_view Text(const JsonNode &node) const {
        return std::string_view(chars).substr(node.textAt, node.textLength);
    }
    /// Index in `nodes` of the member of that name, 0 when there is none. Error when there are two.
    std::size_t Find(std::size_t object, std::string_view member) const;
    /// Name or name[index], fit for a message.
    std::string Label() const;
    /// Throws "file: label: text".
    [[noreturn]] void Fail(std::string_view text) const;
};

/// Calls `record` for every member of the top-level object in the order of the file; if the member `list` is an array,
/// for every element of it. Memory use does not grow with the number of records. Errors: Error naming file and member:
/// no such file, not JSON, no object, nested too deep.
void ReadJsonRecords(const std::filesystem::path &path, std::string_view list,
                     const std::function<void(const JsonRecord &)> &record);

/// Text of a file, shortened to one line for messages.
std::string ShownText(std::string_view text);

} // namespace q3
