"""Types of LCM messages out of their .lcm texts: decoding and encoding without generated code.

A type is a class with a member of each field: numbers, texts, arrays (numpy, of numbers) and lists (of texts and other messages). Constants stand in the
class. The texts are those of this version; `Types.of_log` takes those that stand in a log, so that logs of any version can be read."""
import pathlib
import re
import struct

import numpy

_NUMBERS = {'int8_t': '>i1', 'byte': 'u1', 'boolean': 'i1', 'int16_t': '>i2', 'int32_t': '>i4', 'int64_t': '>i8', 'float': '>f4', 'double': '>f8'}
_MASK = (1 << 64) - 1


class DecodeError(ValueError):
    """Bytes that are no message of their type."""


class Message:
    """What the types have in common. Members are those of `fields`, all zero and empty at first."""
    fields = ()
    type_name = ''
    fingerprint = 0

    def __init__(self, **members):
        for field in self.fields:
            setattr(self, field.name, field.empty())
        for name, value in members.items():
            if not hasattr(self, name):
                raise AttributeError(f'{self.type_name} has no member {name}')
            setattr(self, name, value)

    @classmethod
    def decode(cls, data):
        """@raise DecodeError: bytes of another type, too few or too many, or counts that they cannot fill"""
        data = memoryview(data)
        if len(data) < 8 or struct.unpack_from('>Q', data)[0] != cls.fingerprint:
            raise DecodeError(f'no message of {cls.type_name}')
        message, end = cls._take(data, 8)
        if end != len(data):
            raise DecodeError(f'{cls.type_name}: {len(data) - end} bytes too many')
        return message

    @classmethod
    def _take(cls, data, at):
        message = cls.__new__(cls)
        for field in cls.fields:
            value, at = field.take(data, at, message)
            setattr(message, field.name, value)
        return message, at

    def encode(self):
        """Counts are set by their arrays. @raise ValueError: arrays of one count that are not equally long"""
        self._set_counts()
        parts = [struct.pack('>Q', self.fingerprint)]
        self._put(parts)
        return b''.join(parts)

    def _put(self, parts):
        for field in self.fields:
            field.put(getattr(self, field.name), self, parts)

    def _set_counts(self):
        sizes = {}
        for field in self.fields:
            value = getattr(self, field.name)
            if field.sizes and field.sizes[0] in self._counts:
                if sizes.setdefault(field.sizes[0], len(value)) != len(value):
                    raise ValueError(f'{self.type_name}: arrays of {field.sizes[0]} are not equally long')
            if field.message_type:
                for one in (value if field.sizes else [value]):
                    one._set_counts()
        for name, size in sizes.items():
            setattr(self, name, size)

    def __repr__(self):
        texts = []
        for field in self.fields:
            value = getattr(self, field.name)
            texts.append(f'{field.name}=[{len(value)}]' if field.sizes and len(value) > 8 else f'{field.name}={value!r}')
        return f'{self.type_name}({", ".join(texts)})'


class _Field:
    """A member of a type: its name, the name of its type, the sizes of its dimensions (numbers, or members before it)."""

    def __init__(self, kind, name, sizes):
        self.kind, self.name, self.sizes = kind, name, sizes
        self.dtype = numpy.dtype(_NUMBERS[kind]) if kind in _NUMBERS else None
        self.message_type = None

    def empty(self):
        if self.sizes:
            shape = [size if isinstance(size, int) else 0 for size in self.sizes]
            return numpy.zeros(shape, self.dtype.newbyteorder('=')) if self.dtype else []
        if self.message_type:
            return self.message_type()
        return '' if self.kind == 'string' else False if self.kind == 'boolean' else 0.0 if self.dtype.kind == 'f' else 0

    def take(self, data, at, message):
        if not self.sizes:
            return self._one(data, at)
        shape = [size if isinstance(size, int) else getattr(message, size) for size in self.sizes]
        count = 1
        for size in shape:
            if size < 0:
                raise DecodeError(f'{self.name}: a count below 0')
            count *= size
        if self.dtype is None:
            if count > len(data) - at:
                raise DecodeError(f'{self.name}: cut off')
            values = []
            for _ in range(count):
                value, at = self._one(data, at)
                values.append(value)
            return values, at
        end = at + count * self.dtype.itemsize
        if end > len(data):
            raise DecodeError(f'{self.name}: cut off')
        return numpy.frombuffer(data[at:end], self.dtype).astype(self.dtype.newbyteorder('=')).reshape(shape), end

    def _one(self, data, at):
        if self.message_type:
            return self.message_type._take(data, at)
        if self.kind == 'string':
            size = int(self._number(data, at, '>i4'))
            end = at + 4 + size
            if size < 1 or end > len(data) or data[end - 1] != 0:
                raise DecodeError(f'{self.name}: no text')
            return bytes(data[at + 4:end - 1]).decode('utf-8', 'replace'), end
        value = self._number(data, at, self.dtype)
        return (bool(value) if self.kind == 'boolean' else value.item()), at + self.dtype.itemsize

    def _number(self, data, at, dtype):
        dtype = numpy.dtype(dtype)
        if at + dtype.itemsize > len(data):
            raise DecodeError(f'{self.name}: cut off')
        return numpy.frombuffer(data[at:at + dtype.itemsize], dtype)[0]

    def put(self, value, message, parts):
        if self.sizes and self.dtype is not None:
            fixed = [size for size in self.sizes if isinstance(size, int)]
            array = self._as_stored(value)
            may_be_empty = len(fixed) < len(self.sizes) and not array.size
            if list(array.shape[len(self.sizes) - len(fixed):]) != fixed and not may_be_empty:
                raise ValueError(f'{self.name} has the shape {array.shape}, not {self.sizes}')
            parts.append(array.tobytes())
            return
        for one in (value if self.sizes else [value]):
            if self.message_type:
                one._put(parts)
            elif self.kind == 'string':
                text = one.encode('utf-8') + b'\0'
                parts.append(struct.pack('>i', len(text)) + text)
            else:
                parts.append(self._as_stored(one).tobytes())

    def _as_stored(self, value):
        given = numpy.asarray(value)
        stored = given.astype(self.dtype)
        if stored.dtype.kind == 'i' and given.dtype.kind in 'iuO' and not numpy.array_equal(stored, given):
            raise ValueError(f'{self.name}: {value} has no room in {self.kind}')
        return stored


def _hash_update(value, number):
    shifted = ((value << 8) & _MASK) ^ ((value >> 55) | (_MASK & ~(_MASK >> 55) if value >> 63 else 0))
    return (shifted + number) & _MASK


def _hash_text(value, text):
    value = _hash_update(value, len(text))
    for letter in text.encode():
        value = _hash_update(value, letter)
    return value


class Types:
    """Classes of all types, as attributes: `types.obstacles_t`."""

    def __init__(self, texts):
        """@param texts: of .lcm files, a struct each"""
        self._classes = {}
        for text in texts:
            self._add(text)
        for made in self._classes.values():
            for field in made.fields:
                if field.kind not in _NUMBERS and field.kind != 'string':
                    field.message_type = self._classes[field.kind]
        for made in self._classes.values():
            made.fingerprint = self._fingerprint(made, ())

    def _add(self, text):
        text = re.sub(r'//[^\n]*', '', text)
        name, body = re.search(r'struct\s+(\w+)\s*\{(.*)\}', text, re.S).groups()
        members, fields = {}, []
        for statement in body.split(';'):
            words = statement.split(None, 1)
            if not words:
                continue
            if words[0] == 'const':
                kind, constants = words[1].split(None, 1)
                for constant in constants.split(','):
                    key, value = (part.strip() for part in constant.split('='))
                    members[key] = float(value) if kind in ('float', 'double') else int(value, 0)
                continue
            for declared in words[1].split(','):
                member = re.match(r'\s*(\w+)', declared).group(1)
                sizes = [int(size) if size.isdigit() else size for size in re.findall(r'\[\s*(\w+)\s*\]', declared)]
                fields.append(_Field(words[0].split('.')[-1], member, sizes))
        members['fields'] = tuple(fields)
        members['type_name'] = name
        members['_counts'] = {size for field in fields for size in field.sizes if isinstance(size, str)}
        self._classes[name] = type(name, (Message,), members)

    def _fingerprint(self, made, parents):
        if made in parents:
            return 0
        value = 0x12345678
        for field in made.fields:
            value = _hash_text(value, field.name)
            if field.message_type is None:
                value = _hash_text(value, field.kind)
            value = _hash_update(value, len(field.sizes))
            for size in field.sizes:
                value = _hash_update(value, 0 if isinstance(size, int) else 1)
                value = _hash_text(value, str(size))
        for field in made.fields:
            if field.message_type is not None:
                value = (value + self._fingerprint(field.message_type, parents + (made,))) & _MASK
        return ((value << 1) | (value >> 63)) & _MASK

    def __getattr__(self, name):
        try:
            return self.__dict__['_classes'][name]
        except KeyError:
            raise AttributeError(f'there is no type {name}') from None

    def __iter__(self):
        return iter(self._classes.values())

    def __len__(self):
        return len(self._classes)

    def by_fingerprint(self, fingerprint):
        """@return the type; None where none has it"""
        return next((made for made in self._classes.values() if made.fingerprint == fingerprint), None)


def _texts_of_this_version():
    folder = pathlib.Path(__file__).parent
    for place in (folder / 'lcmtypes', folder.parents[1] / 'lcmtypes'):
        texts = [file.read_text(encoding='utf-8') for file in sorted(place.glob('*.lcm'))]
        if texts:
            return texts
    raise ImportError(f'no .lcm files beside {folder}')


this_version = Types(_texts_of_this_version())
