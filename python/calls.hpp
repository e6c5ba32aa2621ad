// This file is part of the refract project. It is subject to the license terms in the LICENSE file at its top level.
// SPDX-License-Identifier: Apache-2.0

// What stands before every generated function: of the forms of a call it chooses the one that takes these arguments. If there is
// none, it says why, before anything is converted. The generator fills the tables (generator/signatures.py).
#pragma once

enum Kind
{
    ARRAY, ARRAY_OR_NUMBER, ARRAYS, ARRAYS_OF_VIEWS,    // read; None is an empty one
    OUTPUT, OUTPUTS,                                    // an array to write into
    CAMERA, CAMERAS, WINDOW, NUMBER, NUMBER_OR_NONE,
    INTEGER, INTEGER_64, BOOLEAN, PAIR, VECTOR, INTEGERS, TEXT, TEXTS, CRITERIA, NODE, STORAGE,
    RIG_OPTIONS, BUNDLE_OPTIONS,
    GlassCalibrationFlags, TriangulateFlags, RectifyFlags
};

struct Argument
{
    const char* name;
    Kind kind;
    bool required;
};

struct Form
{
    PyObject* (*function)(PyObject* self, PyObject* args, PyObject* keywords);
    const Argument* arguments;
    int count;
};

struct Call
{
    const char* name;
    const Form* forms;
    int count;
    bool returnsFlags;      // as the first of its results
};

//! The enumeration of flags; an int until the package has set it.
static PyObject* flagsType = (PyObject*)&PyLong_Type;

static bool isTruth(PyObject* o) { return PyBool_Check(o) || PyArray_IsScalar(o, Bool); }

//! Python's and NumPy's, also an array without dimensions; not True, which is an int.
static bool isNumber(PyObject* o)
{
    if (PyFloat_Check(o) || (PyLong_Check(o) && !PyBool_Check(o)))
        return true;
    return PyArray_CheckScalar(o) ? !isTruth(o) && (PyArray_IsScalar(o, Number) || PyArray_Check(o)) : false;
}

static bool isInteger(PyObject* o)
{
    return (PyLong_Check(o) && !PyBool_Check(o)) || PyArray_IsScalar(o, Integer);
}

//! An integer that C++'s int holds.
static bool isInt(PyObject* o)
{
    PySafeObject number(isInteger(o) ? PyNumber_Index(o) : NULL);
    const long value = number ? PyLong_AsLong(number) : 0;
    const bool holds = number && value == (int)value && !PyErr_Occurred();
    PyErr_Clear();
    return holds;
}

static bool isList(PyObject* o) { return PyList_Check(o) || PyTuple_Check(o); }

static bool isListOfTexts(PyObject* o)
{
    PyObject* const first = PyList_Check(o) && PyList_Size(o) > 0 ? PyList_GetItem(o, 0)
                            : PyTuple_Check(o) && PyTuple_Size(o) > 0 ? PyTuple_GetItem(o, 0) : NULL;
    return first && PyUnicode_Check(first);
}

static bool isOf(PyObject* o, PyObject* type) { return (PyObject*)Py_TYPE(o) == type; }      // which none is derived from

static bool isText(PyObject* o) { return PyUnicode_Check(o) || PyBytes_Check(o) || PyObject_HasAttrString(o, "__fspath__"); }

//! What an argument must be, in words; NULL if o is that.
static const char* mismatch(PyObject* o, const Argument& argument)
{
    if (o == Py_None && !argument.required)
        return NULL;
    switch (argument.kind)
    {
    case ARRAY:
        return o == Py_None || (PyArray_Check(o) && PyArray_NDIM((PyArrayObject*)o) > 0) || (isList(o) && !isListOfTexts(o))
            ? NULL : "an array";
    case ARRAY_OR_NUMBER: return o == Py_None || PyArray_Check(o) || isList(o) || isNumber(o) ? NULL : "an array or a number";
    case ARRAYS: return o == Py_None || PyArray_Check(o) || isList(o) ? NULL : "a list of arrays";
    case ARRAYS_OF_VIEWS: return o == Py_None || PyArray_Check(o) || isList(o) ? NULL : "a list of lists of arrays";
    case OUTPUT: return PyArray_Check(o) ? NULL : "an array to write into, or None";
    case OUTPUTS: return isList(o) || PyArray_Check(o) ? NULL : "arrays to write into, or None";
    case CAMERA: return isOf(o, pyopencv_refract_RefractiveCamera_TypePtr) ? NULL : "a RefractiveCamera";
    case CAMERAS: return isList(o) ? NULL : "a list of RefractiveCamera";
    case WINDOW: return o == Py_None || isOf(o, pyopencv_refract_GlassWindow_TypePtr) ? NULL : "a GlassWindow";
    case NUMBER: return isNumber(o) ? NULL : "a number";
    case NUMBER_OR_NONE: return o == Py_None || isNumber(o) ? NULL : "a number";
    case INTEGER: return isInt(o) ? NULL : isInteger(o) ? "an integer of 32 bits" : "an integer";
    case INTEGER_64: return isInteger(o) ? NULL : "an integer";
    case BOOLEAN: return isTruth(o) || isInt(o) ? NULL : "True or False";
    case PAIR: return PyArray_Check(o) || isList(o) ? NULL : "two integers";
    case VECTOR: return PyArray_Check(o) || isList(o) ? NULL : "a tuple, a list or an array of numbers";
    case INTEGERS: return PyArray_Check(o) || isList(o) ? NULL : "a list of integers";
    case TEXT: return isText(o) ? NULL : "a str or a path";
    case TEXTS: return isListOfTexts(o) ? NULL : "a list of str";
    case CRITERIA: return isList(o) ? NULL : "a tuple (type, iterations, epsilon)";
    case RIG_OPTIONS: return isOf(o, pyopencv_refract_GlassRigOptions_TypePtr) ? NULL : "a GlassRigOptions";
    case BUNDLE_OPTIONS: return isOf(o, pyopencv_refract_BundleAdjustOptions_TypePtr) ? NULL : "a BundleAdjustOptions";
    case NODE: return isOf(o, pyopencv_FileNode_TypePtr) ? NULL : "a FileNode";
    case STORAGE: return isOf(o, pyopencv_FileStorage_TypePtr) ? NULL : "a FileStorage";
    default: return isInteger(o) ? NULL : "flags";
    }
}

static String textOf(PyObject* o)
{
    PySafeObject text(PyObject_Repr(o));
    std::string characters;
    if (!text || !getUnicodeString(text, characters))
        PyErr_Clear();
    return characters;
}

static String nameOf(PyTypeObject* type)
{
    PySafeObject name(PyObject_GetAttrString((PyObject*)type, "__name__"));     // OpenCV's function for this leaks
    std::string characters;
    if (!name || !getUnicodeString(name, characters))
        PyErr_Clear();
    return characters;
}

//! As a sentence says it: a value that is short, else the type.
static String describe(PyObject* o)
{
    if (o == Py_None)
        return "None";
    const String value = isTruth(o) || isNumber(o) || PyUnicode_Check(o) ? textOf(o) : String();
    return value.empty() || value.size() > 60 ? "of type " + nameOf(Py_TYPE(o)) : value;
}

static bool isOutput(const Argument& argument) { return argument.kind == OUTPUT || argument.kind == OUTPUTS; }

//! A value in the place of an output, or of something else that may be left out, is most often that of a later argument.
static String explain(PyObject* o, const Form& form, const Argument& argument, const char* wanted)
{
    const String text = format("%s is %s; it must be %s", argument.name, describe(o).c_str(), wanted);
    for (const Argument* later = &argument + 1; !argument.required && later < form.arguments + form.count; later++)
        if (!isOutput(*later) && !mismatch(o, *later))
            return text + format(". Give %s by its name: %s=...", later->name, later->name);
    return text;
}

//! The given value of argument i: by position or by name. NULL: there is none.
static PyObject* given(const Form& form, int i, PyObject* args, PyObject* keywords)
{
    if (i < PyTuple_Size(args))
        return PyTuple_GetItem(args, i);
    return keywords ? PyDict_GetItemString(keywords, form.arguments[i].name) : NULL;
}

//! Whether every name is one of the form's, and none is given twice.
static bool namesFit(const Form& form, Py_ssize_t positions, PyObject* keywords, String* why)
{
    PyObject *key, *value;
    for (Py_ssize_t next = 0; PyDict_Next(keywords, &next, &key, &value);)
    {
        int i = 0;
        while (i < form.count && PyUnicode_CompareWithASCIIString(key, form.arguments[i].name) != 0)
            i++;
        if (i >= positions && i < form.count)
            continue;
        if (why)
            *why = format(i < form.count ? "%s is given twice" : "there is no argument %s", textOf(key).c_str());
        return false;
    }
    return true;
}

//! Whether the form takes these arguments, and if not, why; without why it is quick.
static bool fits(const Form& form, PyObject* args, PyObject* keywords, String* why = NULL)
{
    const Py_ssize_t positions = PyTuple_Size(args);
    if (positions > form.count)
    {
        if (why)
            *why = format("it takes at most %d arguments; %d are given", form.count, (int)positions);
        return false;
    }
    const bool named = keywords && PyDict_Size(keywords) > 0;
    if (named && !namesFit(form, positions, keywords, why))
        return false;
    for (int i = 0; i < form.count; i++)
    {
        const Argument& argument = form.arguments[i];
        if (i >= positions && !named && !argument.required)
            break;
        PyObject* const o = given(form, i, args, named ? keywords : NULL);
        const char* const wanted = o ? mismatch(o, argument) : argument.required ? "" : NULL;
        if (!wanted)
            continue;
        if (why)
            *why = o ? explain(o, form, argument, wanted) : format("%s is missing", argument.name);
        return false;
    }
    return true;
}

//! @param attributes of the exception: a dictionary, or NULL where it could not be made
static bool setAttributes(PyObject* error, PyObject* attributes)
{
    PyObject *key, *value;
    for (Py_ssize_t next = 0; attributes && PyDict_Next(attributes, &next, &key, &value);)
        if (PyObject_SetAttr(error, key, value) != 0)
            return false;
    return attributes != NULL;
}

//! Members of CalibrationError; a cause by its name.
static PyObject* attributesOf(const refract::CalibrationError& e)
{
    static const char* const CAUSES[] = { "NOT_CONVERGED", "UNDETERMINED", "POSE_UNDETERMINED", "TOO_FEW_INLIERS", "TOO_FEW_POINTS",
                                          "NO_SCALE", "NO_POSE", "NO_IMAGE", "WINDOW_NOT_SEEN", "LOOKS_AWAY", "BEYOND_WINDOW",
                                          "PAIRS_SWAPPED", "PAIRS_CONTRADICT" };
    static_assert(sizeof(CAUSES)/sizeof(CAUSES[0]) == refract::CalibrationError::PAIRS_CONTRADICT + 1, "a name for each");
    return Py_BuildValue("{s:s,s:s,s:i,s:i,s:i}", "cause", CAUSES[e.cause], "reason", e.reason.c_str(), "view", e.view, "camera", e.camera,
                         "point", e.point);
}

//! An exception as those of C++: attributes of the exception itself, and a text without paths of the machine that compiled it.
static void raise(const Exception& e)
{
    PySafeObject message(PyUnicode_DecodeUTF8(e.err.c_str(), (Py_ssize_t)e.err.size(), "replace"));
    PySafeObject error(message ? PyObject_CallFunctionObjArgs(opencv_error, (PyObject*)message, NULL) : NULL);
    const String file = e.file.substr(e.file.find_last_of("/\\") + 1);
    PySafeObject attributes(error ? Py_BuildValue("{s:s,s:s,s:i,s:i,s:O,s:O}", "file", file.c_str(), "func", e.func.c_str(), "line", e.line,
                                                  "code", e.code, "err", (PyObject*)message, "msg", (PyObject*)message) : NULL);
    if (!setAttributes(error, attributes))
        return;
    const refract::CalibrationError* const ofCalibration = dynamic_cast<const refract::CalibrationError*>(&e);
    PySafeObject more(ofCalibration ? attributesOf(*ofCalibration) : NULL);
    if (ofCalibration && !setAttributes(error, more))
        return;
    PyErr_SetObject(opencv_error, error);
}

static void raise(const String& text, int code = Error::StsBadArg) { raise(Exception(code, text, "", "", 0)); }

//! What conversions raise becomes the one class for wrong arguments, with the name of the call.
static void blame(const char* name)
{
    if (!PyErr_ExceptionMatches(PyExc_TypeError) && !PyErr_ExceptionMatches(PyExc_ValueError)
        && !PyErr_ExceptionMatches(PyExc_OverflowError))
        return;
    PySafeObject type, value, traceback;
    PyErr_Fetch(type, value, traceback);
    PyErr_NormalizeException(type, value, traceback);
    PySafeObject text(PyObject_Str(value));
    std::string message;
    if (!text || !getUnicodeString(text, message))
        PyErr_Clear();
    raise(String(name) + ": " + message);
}

static String formText(const Form& form)
{
    String text;
    for (int i = 0; i < form.count; i++)
        text += String(i ? ", " : "") + form.arguments[i].name + (form.arguments[i].required ? "" : "=...");
    return "(" + text + ")";
}

//! How many arguments from the first on are what the form wants.
static int agreeing(const Form& form, PyObject* args)
{
    int i = 0;
    while (i < form.count && i < PyTuple_Size(args) && !mismatch(PyTuple_GetItem(args, i), form.arguments[i]))
        i++;
    return i;
}

//! No form fits: the reason of the one that was meant, that is, of those that agree with most of the arguments.
static PyObject* refuse(const Call& call, PyObject* args, PyObject* keywords)
{
    int most = 0;
    for (int i = 0; i < call.count; i++)
        most = std::max(most, agreeing(call.forms[i], args));
    std::vector<String> reasons;
    for (int i = 0; i < call.count; i++)
    {
        String why;
        fits(call.forms[i], args, keywords, &why);
        if (agreeing(call.forms[i], args) == most)
            reasons.push_back(call.count == 1 ? why : why + ", for " + call.name + formText(call.forms[i]));
    }
    String text = String(call.name) + ": ";
    for (const String& reason : reasons)
        text += (reasons.size() > 1 ? "\n  " : "") + reason;
    raise(text);
    return NULL;
}

// Flags that keep a lens parameter where it is; they mean nothing where it is not free.
static const int FIX_OF_LENS = refract::GLASS_FIX_PRINCIPAL_POINT | refract::GLASS_FIX_FOCAL_LENGTH | refract::GLASS_FIX_K1
    | refract::GLASS_FIX_K2 | refract::GLASS_FIX_K3 | refract::GLASS_FIX_K4 | refract::GLASS_FIX_K5 | refract::GLASS_FIX_K6
    | refract::GLASS_FIX_TANGENT_DIST | refract::GLASS_FIX_S1_S2_S3_S4 | refract::GLASS_FIX_TAUX_TAUY;

//! Whether a field of options has an array.
static bool hasArray(PyObject* options, const char* field)
{
    PySafeObject value(PyObject_HasAttrString(options, field) ? PyObject_GetAttrString(options, field) : NULL);
    return value && (PyTuple_Check(value) ? PyTuple_Size(value) > 0 : value != Py_None);
}

//! A plain number may be a flag of cv2, which means something else here; false and an exception then.
static bool checkFlags(const Call& call, const Form& form, PyObject* args, PyObject* keywords)
{
    PyObject *flags = NULL, *options = NULL;
    for (int i = 0; i < form.count; i++)
    {
        if (form.arguments[i].kind == GlassCalibrationFlags)
            flags = given(form, i, args, keywords);
        else if (form.arguments[i].kind == RIG_OPTIONS || form.arguments[i].kind == BUNDLE_OPTIONS)
            options = given(form, i, args, keywords);
    }
    PySafeObject ofOptions(options && options != Py_None ? PyObject_GetAttrString(options, "flags") : NULL);
    if (ofOptions)
        flags = ofOptions;
    if (!flags || flags == Py_None)
        return true;
    const bool hasPriors = ofOptions && (hasArray(options, "cameraCovariances") || hasArray(options, "rigCovariance"));
    const long value = PyLong_AsLong(flags);
    if (value == -1 && PyErr_Occurred())
        return false;
    if (value != 0 && !PyObject_IsInstance(flags, flagsType))
    {
        raise(format("%s: flags is the plain number %ld. Take the GLASS_... of opencv_refract: a flag of cv2 means something else "
                     "here (a number of your own: GlassCalibrationFlags(%ld))", call.name, value, value));
        return false;
    }
    if (!(value & FIX_OF_LENS) || (value & refract::GLASS_FREE_INTRINSICS) || hasPriors || call.returnsFlags)
        return true;
    return PyErr_WarnFormat(PyExc_UserWarning, 1, "%s: a lens parameter is fixed (%s), but without GLASS_FREE_INTRINSICS the "
                            "whole lens is: this flag has no effect", call.name, textOf(flags).c_str()) == 0;
}

//! Its first result as flags; takes the reference.
static PyObject* withFlags(PyObject* results)
{
    const bool several = PyTuple_Check(results);
    PyObject* const flags = PyObject_CallFunctionObjArgs(flagsType, several ? PyTuple_GetItem(results, 0) : results, NULL);
    if (!flags || !several)
    {
        Py_DECREF(results);
        return flags;
    }
    PySafeObject all(PySequence_List(results));
    Py_DECREF(results);
    if (!all || PyList_SetItem(all, 0, flags) != 0)
        return NULL;
    return PyList_AsTuple(all);
}

static bool takesFlags(const Form& form)
{
    for (int i = form.count - 1; i >= 0; i--)
        if (form.arguments[i].kind == GlassCalibrationFlags || form.arguments[i].kind == RIG_OPTIONS
            || form.arguments[i].kind == BUNDLE_OPTIONS)
            return true;
    return false;
}

//! Every call comes here.
static PyObject* choose(const Call& call, PyObject* self, PyObject* args, PyObject* keywords)
{
    for (int i = 0; i < call.count; i++)
    {
        const Form& form = call.forms[i];
        if (!fits(form, args, keywords))
            continue;
        if (takesFlags(form) && !checkFlags(call, form, args, keywords))
            return NULL;
        PyObject* const results = form.function(self, args, keywords);
        if (!results)
            blame(call.name);
        return results && call.returnsFlags ? withFlags(results) : results;
    }
    return refuse(call, args, keywords);
}
