"""Hashes of objects by their content."""


class Hashable:
    """Base of classes whose objects are hashed by their current content."""

    def mutable_hash(self, obj_hash=None):
        """Hash object with the content added: ``obj_hash``, or a new SHA-256."""
        import hashlib  # as late as this, for it is rarely wanted

        obj_hash = hashlib.sha256() if obj_hash is None else obj_hash
        self.update_hash(obj_hash)
        return obj_hash

    def update_hash(self, obj_hash):
        """Add the attributes of the object to a hash."""
        Hashable.update_hash_from_dict(obj_hash, vars(self))

    @staticmethod
    def get_object_hash_string(object_):
        """Text of a value, encoded as UTF-8."""
        return str(object_).encode("utf-8", "backslashreplace")

    @staticmethod
    def update_hash_from_dict(obj_hash, object_):
        """Add an object to a hash; order only matters in lists and tuples."""
        if isinstance(object_, Hashable):
            object_.update_hash(obj_hash)
        elif isinstance(object_, dict):
            for key in sorted(object_, key=str):
                obj_hash.update(Hashable.get_object_hash_string(key))
                Hashable.update_hash_from_dict(obj_hash, object_[key])
        elif isinstance(object_, (set, frozenset)):
            for text in sorted(map(Hashable.get_object_hash_string, object_)):
                obj_hash.update(text)
        elif isinstance(object_, (list, tuple)):
            for item in object_:
                Hashable.update_hash_from_dict(obj_hash, item)
        else:
            obj_hash.update(Hashable.get_object_hash_string(object_))
