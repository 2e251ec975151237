// SPDX-License-Identifier: BSD-3-Clause
#include "SurfaceNames.h"

#include <algorithm>
#include <cctype>
#include <fstream>

namespace pm {

namespace {

bool isBlank(char c) { return std::isspace(static_cast<unsigned char>(c)) != 0; }

/// A line as its first word and the rest, both without blanks around.
struct Line {
  std::string word, rest;
};

Line split(const std::string& text) {
  const auto wordBegin = std::find_if_not(text.begin(), text.end(), isBlank);
  const auto wordEnd = std::find_if(wordBegin, text.end(), isBlank);
  const auto restBegin = std::find_if_not(wordEnd, text.end(), isBlank);
  auto restEnd = text.end();
  while (restEnd != restBegin && isBlank(*(restEnd - 1))) --restEnd;
  return {std::string(wordBegin, wordEnd), std::string(restBegin, restEnd)};
}

bool startsWithBlankOr(const std::string& text, const char* letters) {
  const auto first = std::find_if_not(text.begin(), text.end(), isBlank);
  return first != text.end() &&
         std::char_traits<char>::find(letters, std::char_traits<char>::length(letters), *first);
}

bool isContinued(const std::string& text) {
  const auto last = std::find_if_not(text.rbegin(), text.rend(), isBlank);
  return last != text.rend() && *last == '\\';
}

}  // namespace

NamedFaces scanObjNames(const std::string& path) {
  std::ifstream file(path);
  std::string text;
  NamedFaces groups, objects;
  bool continued = false;
  while (std::getline(file, text)) {
    const bool continues = continued;
    continued = isContinued(text);
    if (continues || !startsWithBlankOr(text, "fgo")) continue;
    const Line line = split(text);
    if (line.word == "f") ++groups.faces;
    if (line.word == "g") groups.runs.push_back({groups.faces, line.rest});
    if (line.word == "o") objects.runs.push_back({groups.faces, line.rest});
  }
  objects.faces = groups.faces;
  return groups.runs.empty() ? objects : groups;
}

std::vector<std::string> scanStlNames(const std::string& path) {
  std::ifstream file(path);
  std::string text;
  std::vector<std::string> names;
  while (std::getline(file, text)) {
    if (!startsWithBlankOr(text, "sS")) continue;
    Line line = split(text);
    std::transform(line.word.begin(), line.word.end(), line.word.begin(),
                   [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    if (line.word == "solid") names.push_back(line.rest);
  }
  return names;
}

}  // namespace pm
