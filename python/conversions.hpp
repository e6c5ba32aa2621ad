// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// Conversions of ours between Python's values and C++'s, where those of cv2 take too little (integers, lists, other layouts), or
// too much. The generated code finds them before the templates of cv2_convert.hpp.
#pragma once

/* Arrays of the other byte order, and views into packed records, are copied first: the conversions of cv2 take them as if they
were native and aligned. */
template<typename Conversion>
static bool convert(PyObject* o, const ArgInfo& info, Conversion conversion)
{
    if (!o || !PyArray_Check(o) || PyArray_ISBEHAVED_RO((PyArrayObject*)o))
        return conversion(o);
    if (info.outputarg)
    {
        failmsg("%s is written to; its numbers must be aligned and in this machine's byte order", info.name);
        return false;
    }
    PySafeObject copy(PyArray_FROM_OF(o, NPY_ARRAY_ALIGNED | NPY_ARRAY_NOTSWAPPED));
    return copy && conversion(copy);
}

//! Pixels, points and images: what is not real there is a mistake, or has a meaning.
static bool keepsItsType(const char* name)
{
    static const char* const BEGINNINGS[] = { "imag", "objectPoints", "points", "src", "disparity", "undistorted" };
    for (const char* beginning : BEGINNINGS)
        if (strncmp(name, beginning, strlen(beginning)) == 0)
            return strcmp(name, "disparitySigma") != 0;
    return false;
}

//! A list or a tuple of numbers as a column.
static bool fromNumbers(PyObject* o, Mat& m, const ArgInfo& info)
{
    const Py_ssize_t count = PySequence_Size(o);
    m = Mat((int)count, 1, CV_64F);
    for (Py_ssize_t i = 0; i < count; i++)
    {
        PySafeObject item(PySequence_GetItem(o, i));
        if (!item || !isNumber(item))
        {
            failmsg("%s is a list of what is no number; it must be an array, np.array(...)", info.name);
            return false;
        }
        m.at<double>((int)i) = PyFloat_AsDouble(item);
    }
    return !PyErr_Occurred();
}

static bool pyopencv_to(PyObject* o, Mat& m, const ArgInfo& info)
{
    const bool isArray = o && PyArray_Check(o);
    if (isArray && !info.outputarg && PyArray_ISINTEGER((PyArrayObject*)o) && !keepsItsType(info.name))
    {
        PySafeObject reals(PyArray_FROM_OTF(o, NPY_DOUBLE, NPY_ARRAY_CARRAY_RO));
        return reals && pyopencv_to<Mat>((PyObject*)reals, m, info);
    }
    if (isArray || !o || info.outputarg || o == Py_None)
        return convert(o, info, [&](PyObject* array) { return pyopencv_to<Mat>(array, m, info); });
    if (isList(o))
        return fromNumbers(o, m, info);
    if (isNumber(o))
    {
        m = Mat(1, 1, CV_64F, Scalar(PyFloat_AsDouble(o)));
        return !PyErr_Occurred();
    }
    return pyopencv_to<Mat>(o, m, info);
}

//! Each item by its own name, as Rs[1].
template<typename T>
static bool fromItems(PyObject* o, std::vector<T>& v, const ArgInfo& info)
{
    if (!o || o == Py_None)
        return true;
    if (!PySequence_Check(o) || (PyArray_Check(o) && PyArray_NDIM((PyArrayObject*)o) == 0))
    {
        failmsg("%s is no list of arrays", info.name);
        return false;
    }
    const Py_ssize_t count = PySequence_Size(o);
    std::vector<T> items((size_t)std::max<Py_ssize_t>(count, 0));       // not into what was there: None is an empty one
    for (Py_ssize_t i = 0; i < count; i++)
    {
        const String name = format("%s[%d]", info.name, (int)i);
        PySafeObject item(PySequence_GetItem(o, i));
        if (!item || !pyopencv_to(item, items[(size_t)i], ArgInfo(name.c_str(), info.outputarg)))
            return false;
    }
    v.swap(items);
    return count >= 0;
}

static bool pyopencv_to(PyObject* o, std::vector<Mat>& v, const ArgInfo& info) { return fromItems(o, v, info); }
static bool pyopencv_to(PyObject* o, std::vector<std::vector<Mat> >& v, const ArgInfo& info) { return fromItems(o, v, info); }

//! What a call reads and writes: the caller's stays, also a view of any layout.
static bool takeCopy(PyObject* o, Mat& m, const ArgInfo& info)
{
    Mat theirs;
    if (!pyopencv_to_safe(o, theirs, info))
        return false;
    m.allocator = &GetNumpyAllocator();
    theirs.copyTo(m);
    return true;
}

static bool takeCopy(PyObject* o, std::vector<Mat>& v, const ArgInfo& info)
{
    std::vector<Mat> theirs;
    if (!pyopencv_to_safe(o, theirs, info))
        return false;
    for (const Mat& m : theirs)
        v.push_back(m.clone());
    return true;
}

template<int n>
static bool pyopencv_to(PyObject* o, Vec<double, n>& v, const ArgInfo& info)
{
    if (!o || o == Py_None)
        return true;
    Mat m;
    if (!pyopencv_to(o, m, ArgInfo(info.name, 0)))
        return false;
    if ((int)m.total()*m.channels() != n || (m.depth() != CV_64F && m.depth() != CV_32F))
    {
        failmsg("%s has %d numbers; it must have %d, as a tuple, a list or an array", info.name, (int)m.total()*m.channels(), n);
        return false;
    }
    Mat column = m.isContinuous() ? m : m.clone();
    column.reshape(1, n).convertTo(Mat(n, 1, CV_64F, v.val), CV_64F);
    return true;
}

static bool pyopencv_to(PyObject* o, std::vector<double>& v, const ArgInfo& info)
{
    Mat m;
    if (!o || o == Py_None)
        return true;
    if (!(isList(o) || (PyArray_Check(o) && PyArray_NDIM((PyArrayObject*)o) > 0)) || !pyopencv_to(o, m, ArgInfo(info.name, 0)))
    {
        if (!PyErr_Occurred())
            failmsg("%s is %s; it must be a list or an array of numbers", info.name, describe(o).c_str());
        return false;
    }
    if (!m.empty() && (m.channels() != 1 || m.dims > 2 || (m.rows != 1 && m.cols != 1)))
    {
        failmsg("%s is an array of more than one dimension; it must be a list or an array of numbers", info.name);
        return false;
    }
    v.clear();
    m.convertTo(m, CV_64F);
    if (!m.empty())
        v.assign(m.begin<double>(), m.end<double>());
    return true;
}

static bool pyopencv_to(PyObject* o, int& value, const ArgInfo& info)
{
    if (!o || o == Py_None)
        return true;
    PySafeObject number(isInteger(o) ? PyNumber_Index(o) : NULL);
    if (!number)
    {
        failmsg("%s is %s; it must be an integer", info.name, describe(o).c_str());
        return false;
    }
    const long n = PyLong_AsLong(number);
    if ((n == -1 && PyErr_Occurred()) || n != (int)n)
    {
        failmsg("%s is %s, which is too large", info.name, describe(o).c_str());
        return false;
    }
    value = (int)n;
    return true;
}

static bool pyopencv_to(PyObject* o, std::vector<int>& v, const ArgInfo& info)
{
    if (!o || o == Py_None)
        return true;
    if (!isList(o) && (!PyArray_Check(o) || PyArray_NDIM((PyArrayObject*)o) != 1))
    {
        failmsg("%s is %s; it must be a list of integers", info.name, describe(o).c_str());
        return false;
    }
    v.resize((size_t)PySequence_Size(o));
    for (size_t i = 0; i < v.size(); i++)
    {
        PySafeObject item(PySequence_GetItem(o, (Py_ssize_t)i));
        if (!item || !pyopencv_to(item, v[i], info))
            return false;
    }
    return true;
}

static bool pyopencv_to(PyObject* o, double& value, const ArgInfo& info)
{
    if (!o || o == Py_None)
        return true;
    if (!isNumber(o))
    {
        failmsg("%s is %s; it must be a number", info.name, describe(o).c_str());
        return false;
    }
    value = PyFloat_AsDouble(o);
    return !PyErr_Occurred();
}

static bool pyopencv_to(PyObject* o, float& value, const ArgInfo& info)
{
    double number = value;
    if (!pyopencv_to(o, number, info))
        return false;
    value = (float)number;
    return true;
}

//! A path's own exception (an interruption, too) goes on as it is.
static bool pyopencv_to(PyObject* o, String& value, const ArgInfo& info)
{
    PySafeObject path(o && info.pathlike && !PyUnicode_Check(o) && PyObject_HasAttrString(o, "__fspath__") ? PyOS_FSPath(o) : NULL);
    if (!path && PyErr_Occurred())
        return false;
    return pyopencv_to<String>(path ? (PyObject*)path : o, value, info);
}

//! A tuple, a list or an array of two integers.
static bool pyopencv_to(PyObject* o, Size& size, const ArgInfo& info)
{
    std::vector<int> pair;
    if (!o || o == Py_None)
        return true;
    if (!pyopencv_to(o, pair, info))
        return false;
    if (pair.size() != 2)
    {
        failmsg("%s has %d numbers; it must have two, width and height", info.name, (int)pair.size());
        return false;
    }
    size = Size(pair[0], pair[1]);
    return true;
}

//! The empty array that a matrix without elements is; depth: where it has none of its own.
static PyObject* emptyArray(const Mat& m, int channels, int depth)
{
    npy_intp shape[3] = { 0, channels == 0 ? m.cols : 1, channels };
    const int own = m.flags && m.depth() == CV_32F ? CV_32F : depth;
    return PyArray_SimpleNew(channels > 1 ? 3 : 2, shape, own == CV_8U ? NPY_UINT8 : own == CV_32S ? NPY_INT32 : own == CV_32F ? NPY_FLOAT
                                                          : NPY_DOUBLE);
}

static PyObject* fromOutput(const Mat& m, int channels, int depth)
{
    return m.data ? pyopencv_from<Mat>(m) : emptyArray(m, channels, depth);
}

static PyObject* fromOutput(const std::vector<Mat>& v, int channels, int depth)
{
    PySafeObject items(PyTuple_New((Py_ssize_t)v.size()));
    for (size_t i = 0; i < v.size(); i++)
    {
        PyObject* const item = fromOutput(v[i], channels, depth);
        if (!item || PyTuple_SetItem(items, (Py_ssize_t)i, item) != 0)
            return NULL;
    }
    return items.release();
}

//! A field of a result: masks are the only arrays of a list of which one may be empty.
template<typename T> static PyObject* fromResult(const T& value) { return pyopencv_from(value); }
static PyObject* fromResult(const Mat& m) { return fromOutput(m, 0, CV_64F); }
static PyObject* fromResult(const std::vector<Mat>& v) { return fromOutput(v, 1, CV_8U); }

template<typename T> static T ownCopy(const T& value) { return value; }
static Mat ownCopy(const Mat& m) { return m.clone(); }
template<typename T> static std::vector<T> ownCopy(const std::vector<T>& values)
{
    std::vector<T> copies;
    for (const T& value : values)
        copies.push_back(ownCopy(value));
    return copies;
}

//! Into a field: all of it or, where it cannot be, nothing; arrays are no longer those of the caller.
template<typename T> static bool takeField(PyObject* o, T& field, const ArgInfo& info)
{
    T theirs = T();
    if (!pyopencv_to_safe(o, theirs, info))
        return false;
    field = ownCopy(theirs);
    return true;
}
