// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#ifndef REFRACT_TOOLS_JSON_HPP
#define REFRACT_TOOLS_JSON_HPP

#include <cstddef>
#include <cstdint>
#include <initializer_list>
#include <iosfwd>
#include <stdexcept>
#include <string>
#include <vector>

/* Values of JSON files, written and read by nlohmann's library, whose templates are in json.cpp alone. */
namespace tools {

struct JsonMember;

/* A number, a text, true, false, null, a list or an object, whose members stay in the order in which they came:

    Json json = {{"name", "a"}, {"size", 3}, {"center", {{"x", 0.5}}}, {"none", nullptr}};
    json.set("list", Json::array({1., 2.}));
    json.text(1);  */
class Json
{
public:
    // None of these is inline: each value of an object that is written down would be seven of them.
    Json(std::nullptr_t = nullptr);
    Json(bool flag);
    Json(const void*) = delete;                                 // would be a flag
    Json(int number);
    Json(size_t number);
    Json(double number);
    Json(const char* text);
    Json(const std::string& text);
    Json(const Json& other);
    Json(Json&& other) noexcept;
    Json& operator=(const Json& other);
    Json& operator=(Json&& other) noexcept;
    ~Json();
    Json(const std::vector<double>& numbers);
    Json(const std::vector<int>& numbers);
    Json(const std::vector<std::string>& texts);
    Json(const std::vector<Json>& items);
    Json(std::initializer_list<JsonMember> members);
    static Json array(std::initializer_list<Json> items = {});
    static Json object();

    void append(const Json& item);                              //!< to a list
    void set(const std::string& name, const Json& value);       //!< of an object: added, or in place of what it was
    //! Numbers that are not whole, at any depth: so many digits.
    void roundTo(int digits);

    //! With so many blanks for each level. Numbers have the digits that tell them from all others; nan and infinity are null.
    std::string text(int indent) const;

    //! Why reading fails: the text is no JSON, or a value is not what is asked for.
    class Error : public std::runtime_error
    {
        using std::runtime_error::runtime_error;
    };

    // All throw Error.
    static Json read(std::istream& in);
    const Json& at(const std::string& name) const;
    const Json& at(size_t index) const;
    bool has(const std::string& name) const;                    //!< of an object, else false
    const std::vector<std::string>& names() const { return names_; }        //!< of an object's members, in their order
    bool isObject() const { return kind_ == OBJECT; }
    bool isList() const { return kind_ == LIST; }
    bool isNumber() const { return kind_ == NUMBER || kind_ == WHOLE; }
    bool isText() const { return kind_ == TEXT; }
    const std::vector<Json>& items() const;                     //!< of a list
    const std::string& asText() const;
    bool asFlag() const;
    double asNumber() const;
    std::vector<double> asNumbers() const;
    std::vector<int> asWholes() const;
    std::vector<std::string> asTexts() const;

private:
    friend class JsonConverter;
    enum Kind { NOTHING, FLAG, WHOLE, NUMBER, TEXT, LIST, OBJECT };
    explicit Json(Kind kind) : kind_(kind) {}

    Kind kind_ = NOTHING;
    bool flag_ = false;
    int64_t whole_ = 0;
    double number_ = 0.;
    std::string text_;
    std::vector<std::string> names_;        // of an object's members
    std::vector<Json> items_;               // their values; or those of a list
};

struct JsonMember
{
    std::string name;
    Json value;
};

} // namespace tools

#endif // REFRACT_TOOLS_JSON_HPP
