// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

#include "file_harness.hpp"
#include "formats/point_table.hpp"

// Tables of points of other programs, of several cameras and of a file for each.

const char fuzz::EXTENSION[] = "1.csv";

void fuzz::tryFile(const std::string& path)
{
    for (const std::string& name : {path, path.substr(0, path.size() - 5) + "%d.csv"})
        for (const std::string yFrom : {"", "bottom"})
            try
            {
                const tools::CsvTable table = tools::readPointTable(name, {"id", "u1", "v1"}, "a table", {yFrom, {cv::Size(640, 480)}});
                for (const tools::CsvTable::Row& row : table.rows())
                    promise(row.cells.size() == table.names().size(), "each row has a cell for each name");
            }
            catch (const tools::Failure&)       // the other name, or with the other option
            {
            }
}
